/// The error for words of the command line that no option and no argument takes.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace lab::runner {

/// Names the first word, in the order in which they were typed, that the parsed command line left
/// over, and what was probably meant: an option, or a key of the experiment file. An unknown option
/// goes before other words, because CLI11 takes its value for an argument of the command.
/// @return empty: no word is left over
[[nodiscard]] std::string unknownArgument(const CLI::App& app, int argc, const char* const* argv);

/// Whether it names an unknown option.
[[nodiscard]] bool hasUnknownOption(const CLI::App& app);

/// Names an option that takes one value and got several.
/// @return empty: there is none
[[nodiscard]] std::string repeatedOption(const CLI::App& app);

/// An error of the command line, with the command whose help explains what is expected.
[[nodiscard]] std::string withHelp(const CLI::App& app, const std::string& error);

}  // namespace lab::runner
