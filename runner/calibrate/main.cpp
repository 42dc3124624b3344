#include "common/process/installation.hpp"
#include "runner/calibrate/calibrate_commands.hpp"

int main(int argc, char** argv) {
  using namespace lab::runner;
  return commandMain(argc, argv, [](CLI::App& app, Chosen& chosen) {
    addCalibrate(app, chosen, lab::installation().programs);
  });
}
