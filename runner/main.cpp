#include "runner/command_line/command_main.hpp"
#include "runner/commands/command_line.hpp"

int main(int argc, char** argv) {
  using namespace lab::runner;
  return guardedMain([&] { return runCommandLine(argc, argv); });
}
