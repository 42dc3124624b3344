/// The frame of every program with commands: `lab`, and `lab-analyze`, `lab-track` ..., which `lab`
/// executes. All are called `PROGRAM COMMAND ARGUMENTS`, and speak to users as one program.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace lab::runner {

/// What the command line asks for: set while it is parsed, called afterwards. Returns the exit
/// code.
using Chosen = std::function<int()>;

/// Adds commands, whose callbacks set `chosen`.
using AddCommands = std::function<void(CLI::App& app, Chosen& chosen)>;

/// parseArguments() (common/command_line/) in the words of `lab`.
/// @throws UserError
[[nodiscard]] std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv);

/// Parses the command line and does what it asks for.
/// @return the exit code; 2 after an error in the command line. @throws what the commands throw
int runCommands(int argc, char** argv, const AddCommands& add);

/// Calls `command`, and prints what it throws as one line on stderr.
/// @return the exit code
int guardedMain(const std::function<int()>& command);

/// main() of the programs: runCommands() in guardedMain().
int commandMain(int argc, char** argv, const AddCommands& add);

/// A command of `lab` that is a program of its own, so that the first build is short.
struct ProgramCommand {
  const char* name;
  const char* program;  ///< file name in the folder of programs
  const char* summary;  ///< for --help
};

/// nullptr: `lab` itself has the command, or nobody.
[[nodiscard]] const ProgramCommand* findProgramCommand(const std::string& name);

/// The summary of a ProgramCommand. @throws std::out_of_range
[[nodiscard]] const char* summaryOf(const std::string& command);

/// Replaces this process by a program of the lab with the same arguments, and so keeps its pid,
/// terminal and exit code.
/// @throws UserError if it does not exist or cannot be executed
[[noreturn]] void becomeProgram(const std::string& program, char** argv);

}  // namespace lab::runner
