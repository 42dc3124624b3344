#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "runner/commands/commands.hpp"
#include "runner/user_program/python.hpp"

namespace lab::runner {
namespace {

/// Whether Python executes a file, and not the text of -c, a module of -m or what is typed.
bool executesFile(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (!word.starts_with('-')) return true;
    if (word == "-") return false;  // the standard input
    // Letters may be joined, as in -Bc. The value of an option may be in the same word.
    const std::size_t at = word.starts_with("--") ? std::string::npos : word.find_first_of("cmWX");
    if (at != std::string::npos && (word[at] == 'c' || word[at] == 'm')) return false;
    if (at == word.size() - 1 || word == "--check-hash-based-pycs") ++i;
  }
  return false;
}

}  // namespace

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
  // Only a file has its folder first on Python's path. The current folder may be a run of a
  // stranger, with a numpy.py.
  std::vector<std::string> added;
  if (!executesFile(options.arguments)) added.emplace_back("PYTHONSAFEPATH=1");
  std::vector<std::string> environment = pythonEnvironment(std::move(added));
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
