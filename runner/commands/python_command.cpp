#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/commands/commands.hpp"
#include "runner/user_program/python.hpp"

namespace lab::runner {

ExitCode python(const PythonOptions& options) {
  const std::filesystem::path folder = pythonFolder();
  if (folder.empty()) {
    throw UserError("the Python package active_lab is not there: " + pythonHint());
  }
  if (options.where) {
    fmt::print("{}\n", folder.string());
    return kDone;
  }
  std::vector<std::string> arguments{pythonProgram()};
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  std::vector<std::string> environment = pythonEnvironment({});
  // exec takes char* and does not write through it.
  std::vector<char*> argv, envp;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  for (std::string& entry : environment) envp.push_back(entry.data());
  argv.push_back(nullptr);
  envp.push_back(nullptr);
  execvpe(argv.front(), argv.data(), envp.data());
  throw UserError(fmt::format("cannot execute {}: {}; sudo apt-get install python3",
                              arguments.front(), std::strerror(errno)));
}

}  // namespace lab::runner
