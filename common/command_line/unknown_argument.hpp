/// The errors of a command line that CLI11 names badly or not at all: words that no option and no
/// argument takes, options without a value, with several or with a wrong one, a missing command.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/command_line/parse_arguments.hpp"

namespace lab {

/// A command line as typed, and what CLI11 has made of it.
struct TypedCommandLine {
  const CLI::App& app;
  const ProgramWords& words;
  std::vector<std::string> typed;  ///< the program and its arguments
};

/// Names the first word, in the order in which they were typed, that the parsed command line left
/// over, and what was probably meant: an option, or a key of the experiment file. An unknown option
/// goes before other words, because CLI11 takes its value for an argument of the command.
/// @return empty: no word is left over
[[nodiscard]] std::string unknownArgument(const TypedCommandLine& line);

/// Whether it names an unknown option.
[[nodiscard]] bool hasUnknownOption(const TypedCommandLine& line);

/// Names the unknown word and the commands that exist; CLI11 only says that one is missing.
/// @return empty: no command is missing
[[nodiscard]] std::string missingCommand(const TypedCommandLine& line);

/// Names an option that takes one value and got several.
/// @return empty: there is none
[[nodiscard]] std::string repeatedOption(const TypedCommandLine& line);

/// Names an option at the end of the command line that has no value there.
/// @return empty: it does not end with one
[[nodiscard]] std::string missingValue(const TypedCommandLine& line);

/// Names an option that has taken the next option for its value, as in "--out --virtual-time".
/// @return empty: there is none
[[nodiscard]] std::string optionTakenForValue(const TypedCommandLine& line);

/// Names an option whose value is of another type, and that type.
/// @param error of CLI11, about the conversion of a value
/// @return empty: it is not about an option of the chosen command
[[nodiscard]] std::string unconvertedValue(const TypedCommandLine& line, std::string_view error);

/// An error of CLI11, which names an option by the first of its names, with the name that was
/// typed.
[[nodiscard]] std::string withNamesAsTyped(const TypedCommandLine& line, std::string error);

/// An error of the command line, with the command whose help explains what is expected.
[[nodiscard]] std::string withHelp(const TypedCommandLine& line, std::string_view error);

}  // namespace lab
