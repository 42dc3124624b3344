#include "common/command_line/parse_arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>

#include "common/command_line/unknown_argument.hpp"
#include "common/text/printable.hpp"

namespace lab {
namespace {

/// Whether an option has taken `help`, such as "--help", for its value.
bool hasTakenHelp(const CLI::Option& option, const CLI::Option& help) {
  return !option.get_positional() &&
         std::ranges::any_of(option.results(),
                             [&help](const std::string& value) { return help.check_name(value); });
}

/// Whether help was asked for, of the program or of the chosen command.
bool asksForHelp(const CLI::App& app) {
  const CLI::Option* help = app.get_help_ptr();
  if (help == nullptr) return false;
  if (help->count() > 0) return true;
  for (const CLI::Option* option : app.get_options()) {
    if (hasTakenHelp(*option, *help)) return true;
  }
  return std::ranges::any_of(app.get_subcommands(),
                             [](const CLI::App* command) { return asksForHelp(*command); });
}

std::string errorText(const TypedCommandLine& line, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    if (const std::string missing = missingCommand(line); !missing.empty()) return missing;
  }
  const std::string unknown = unknownArgument(line);
  if (hasUnknownOption(line)) return unknown;
  std::string what = optionTakenForValue(line);
  if (!what.empty()) return what;
  const bool only_unknown = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (only_unknown && !unknown.empty()) return unknown;
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {
    what = unconvertedValue(line, error.what());
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    what = repeatedOption(line);
    if (!what.empty() && unknown.empty()) return what;
    if (what.empty()) what = missingValue(line);
  }
  if (what.empty()) what = withNamesAsTyped(line, error.what());
  return unknown.empty() ? withHelp(line, what) : what + "; " + unknown;
}

}  // namespace

std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv,
                                  const ProgramWords& words) {
  const TypedCommandLine line{app, words, {argv, argv + argc}};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version, and options that have done their work
    return app.exit(asked);
  } catch (const CLI::RuntimeError& failed) {  // an option's work has failed, which it has said
    return app.exit(failed);
  } catch (const CLI::ParseError& error) {
    if (!asksForHelp(app)) throw ArgumentError(errorText(line, error));
  } catch (const std::exception&) {  // from the checks of options
    if (!asksForHelp(app)) {
      // CLI11 may have taken the value of an unknown option for an argument, or the value of an
      // option that has taken another one for it.
      if (hasUnknownOption(line)) throw ArgumentError(unknownArgument(line));
      const std::string taken = optionTakenForValue(line);
      if (!taken.empty()) throw ArgumentError(taken);
      throw;
    }
  }
  if (asksForHelp(app)) return app.exit(CLI::CallForHelp());
  const std::string taken = optionTakenForValue(line);
  if (!taken.empty()) throw ArgumentError(taken);
  return std::nullopt;
}

std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv) {
  try {
    return parseArguments(app, argc, argv, {.name = app.get_name()});
  } catch (const ArgumentError& error) {
    std::cerr << app.get_name() << ": " << printable(error.what()) << "\n";
    return 2;
  }
}

}  // namespace lab
