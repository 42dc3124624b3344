#include "runner/campaign/twins/twin_command.hpp"
#include "runner/command_line/command_main.hpp"

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::campaign::addTwin);
}
