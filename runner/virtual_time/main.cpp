#include <CLI/CLI.hpp>
#include <memory>

#include "common/process/installation.hpp"
#include "runner/commands/run_command.hpp"
#include "runner/virtual_time/run_virtual.hpp"

namespace lab::runner {
namespace {

/// `lab run --virtual-time`, which `lab` passes on to this program.
void addRun(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<RunOptions>();
  options->programs = installation().programs;
  CLI::App* command = app.add_subcommand("run", "Run an experiment in virtual time");
  addRunOptions(*command, *options);
  command->callback(
      [&chosen, options] { chosen = [options] { return run(*options, runVirtual); }; });
}

}  // namespace
}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addRun);
}
