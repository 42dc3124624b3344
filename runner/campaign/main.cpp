#include "runner/campaign/queue/queue_command.hpp"
#include "runner/campaign/sweep_command.hpp"
#include "runner/command_line/command_main.hpp"

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, [](CLI::App& app, lab::runner::Chosen& chosen) {
    lab::runner::campaign::addSweep(app, chosen);
    lab::runner::campaign::addQueue(app, chosen);
  });
}
