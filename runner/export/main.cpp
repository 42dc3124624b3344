#include "runner/export/export_command.hpp"

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addExport);
}
