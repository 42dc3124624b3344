/// The command line of every program: help, and errors in one line.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace lab {

/// An error in the command line. The text is one line.
class ArgumentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The type that --help prints for --set, with keys of the experiment file.
inline constexpr const char* kSettingType = "KEY=VALUE";

/// What errors have to know of a program, beside its options.
struct ProgramWords {
  std::string name;  ///< of the program: "lab"
  /// The key of an experiment file that a name stands for, "" if there is none; used for commands
  /// with --set. nullptr: the program has no such command.
  std::string (*key_meant_by)(std::string_view name) = nullptr;
};

/// Parses a command line. If it asks for help, help is printed, whatever errors it has.
/// @return the exit code if the program has nothing more to do; nullopt: it goes on
/// @throws ArgumentError, and what the checks of options throw
[[nodiscard]] std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv,
                                                const ProgramWords& words);

/// The same for a program without commands. An error becomes a line on stderr and exit code 2.
[[nodiscard]] std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv);

}  // namespace lab
