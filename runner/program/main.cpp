#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/command_main.hpp"
#include "runner/program/program_command.hpp"

namespace lab::runner {
namespace {

constexpr const char* kProgram = "A file, or the name of a shipped program";

void addOne(CLI::App& command, Chosen& chosen, const char* name, const char* summary,
            int (*execute)(const std::string&)) {
  auto program = std::make_shared<std::string>();
  CLI::App* one = command.add_subcommand(name, summary);
  one->add_option("PROGRAM", *program, kProgram)->required();
  one->callback(
      [&chosen, program, execute] { chosen = [program, execute] { return execute(*program); }; });
}

void addTrace(CLI::App& command, Chosen& chosen) {
  auto options = std::make_shared<TraceOptions>();
  CLI::App* trace = command.add_subcommand(
      "trace", "Print byte code, times, and the first holds as a robot would execute them");
  trace->add_option("PROGRAM", options->program, kProgram)->required();
  trace->add_option("--holds", options->holds, "Number of holds")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  trace->add_option("--seed", options->seed, "Seed of the draws")
      ->check(wholeNumber())
      ->capture_default_str();
  addSettings(
      *trace, options->set,
      "What the robot reads: light (both sensors), light_front, light_back, ir(0) to ir(5), "
      "each 0 to 1; sense(0) to sense(7); battery in volt; id (repeatable)");
  trace->callback([&chosen, options] { chosen = [options] { return traceProgram(*options); }; });
}

void addProgram(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("program", summaryOf("program"));
  command->require_subcommand(1);
  command->add_subcommand("list", "The shipped programs")->callback([&chosen] {
    chosen = listPrograms;
  });
  addOne(*command, chosen, "show", "Print the text of a program", showProgram);
  addOne(*command, chosen, "check", "Check a program; print its size, ranges and times",
         checkProgram);
  addTrace(*command, chosen);
}

}  // namespace
}  // namespace lab::runner

int main(int argc, char** argv) {
  return lab::runner::commandMain(argc, argv, lab::runner::addProgram);
}
