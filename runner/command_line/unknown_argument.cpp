#include "runner/command_line/unknown_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <vector>

#include "common/experiment/keys/experiment_key_table.hpp"
#include "common/text/nearest_word.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner {
namespace {

using Words = std::vector<std::string>;

bool looksLikeOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word != "--" &&
         std::isdigit(static_cast<unsigned char>(word[1])) == 0 && word[1] != '.';
}

/// The command that was chosen, and its name with those before it: "lab calibrate motors".
struct ChosenCommand {
  const CLI::App* app;
  std::string name;
};

ChosenCommand chosenCommand(const CLI::App& app) {
  ChosenCommand chosen{&app, "lab"};
  while (!chosen.app->get_subcommands().empty()) {
    chosen.app = chosen.app->get_subcommands().front();
    chosen.name += " " + chosen.app->get_name();
  }
  return chosen;
}

Words optionNames(const CLI::App& command) {
  Words names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

Words argumentNames(const CLI::App& command) {
  Words names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) names.push_back(option->get_name(true));
  }
  return names;
}

bool takesKeys(const CLI::App& command) {
  const CLI::Option* set = command.get_option_no_throw("--set");
  return set != nullptr && set->get_type_name() == kSettingType;
}

/// The word after `word` as typed, if it is a value: not an option.
std::string valueAfter(const std::string& word, const Words& typed) {
  if (const std::size_t equals = word.find('='); equals != std::string::npos) {
    return word.substr(equals + 1);
  }
  const auto at = std::ranges::find(typed, word);
  if (at == typed.end() || at + 1 == typed.end() || looksLikeOption(*(at + 1))) return "...";
  return *(at + 1);
}

/// An option of which the beginning was typed; empty if there are none or several.
std::string theOneThatBeginsWith(const std::string& begin, const Words& options) {
  constexpr std::size_t kShortest = 4;  // "--" and two letters
  if (begin.size() < kShortest) return {};
  const auto begins = [&](const std::string& option) { return option.starts_with(begin); };
  return std::ranges::count_if(options, begins) == 1 ? *std::ranges::find_if(options, begins)
                                                     : std::string();
}

std::string unknownOption(const ChosenCommand& command, const std::string& word,
                          const Words& typed) {
  const std::string option = word.substr(0, word.find('='));
  const Words options = optionNames(*command.app);
  std::string key;
  std::string name = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  std::ranges::replace(name, '-', '_');
  if (takesKeys(*command.app)) key = keys::keyMeantBy(name);
  const std::string setting = "--set " + key + "=" + valueAfter(word, typed);
  std::string meant;
  if (!key.empty() && key == name) meant = setting;
  if (option == "--runs" && std::ranges::find(options, "--out") != options.end()) meant = "--out";
  if (meant.empty()) meant = nearestWord(option, options);
  if (meant.empty()) meant = theOneThatBeginsWith(option, options);
  if (meant.empty() && !key.empty()) meant = setting;
  return fmt::format(
      "{}: no such option of `{}`; {}", option, command.name,
      meant.empty() ? command.name + " --help lists them" : "did you mean " + meant + "?");
}

std::string unknownWord(const ChosenCommand& command, const std::string& word) {
  const Words arguments = argumentNames(*command.app);
  const Words options = optionNames(*command.app);
  std::string meant;
  if (std::ranges::find(options, "--" + word) != options.end()) meant = "--" + word;
  if (word.find('=') != std::string::npos && takesKeys(*command.app)) meant = "--set " + word;
  return fmt::format(
      "found \"{}\", but `{}` takes {}; {}", word, command.name,
      arguments.empty() ? std::string("options only")
                        : fmt::format("nothing after {}", fmt::join(arguments, " ")),
      meant.empty() ? command.name + " --help lists its options" : "did you mean " + meant + "?");
}

}  // namespace

std::string repeatedOption(const CLI::App& app) {
  for (const CLI::Option* option : chosenCommand(app).app->get_options()) {
    const bool takes_one = option->get_items_expected_max() == 1;
    if (!takes_one || option->count() < 2) continue;
    return fmt::format("{}: found {} values, {}; keep one", option->get_name(), option->count(),
                       fmt::join(option->results(), " and "));
  }
  return {};
}

std::string withHelp(const CLI::App& app, const std::string& error) {
  return fmt::format("{}; {} --help explains it", error, chosenCommand(app).name);
}

bool hasUnknownOption(const CLI::App& app) {
  return std::ranges::any_of(app.remaining(true), looksLikeOption);
}

std::string unknownArgument(const CLI::App& app, int argc, const char* const* argv) {
  const Words left = app.remaining(true);
  if (left.empty()) return {};
  const Words typed(argv, argv + argc);
  const auto firstOf = [&left, &typed](bool option) -> std::string {
    for (const std::string& word : typed) {
      const bool over = std::ranges::find(left, word) != left.end();
      if (over && looksLikeOption(word) == option) return word;
    }
    return {};
  };
  const ChosenCommand command = chosenCommand(app);
  if (const std::string option = firstOf(true); !option.empty()) {
    return unknownOption(command, option, typed);
  }
  const std::string word = firstOf(false);
  return unknownWord(command, word.empty() ? left.front() : word);
}

}  // namespace lab::runner
