#include "common/command_line/unknown_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstddef>

#include "common/text/nearest_word.hpp"

namespace lab {
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

ChosenCommand chosenCommand(const TypedCommandLine& line) {
  ChosenCommand chosen{&line.app, line.words.name};
  while (!chosen.app->get_subcommands().empty()) {
    chosen.app = chosen.app->get_subcommands().front();
    chosen.name += " " + chosen.app->get_name();
  }
  return chosen;
}

bool contains(const Words& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

/// The names of the options without their dashes. Names of one letter are left out: any other
/// letter is similar to them.
Words optionNames(const CLI::App& command) {
  Words names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
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

/// The names with which an option was typed, in that order.
Words typedNames(const CLI::Option& option, const Words& typed) {
  Words names;
  for (const std::string& word : typed) {
    if (word == "--") break;  // arguments only from here on
    const std::string name = word.substr(0, word.find('='));
    if (looksLikeOption(name) && option.check_name(name) && !contains(names, name)) {
      names.push_back(name);
    }
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

/// A name of which the beginning was typed; empty if there are none or several.
std::string theOneThatBeginsWith(const std::string& begin, const Words& names) {
  if (begin.size() < 2) return {};
  const auto begins = [&](const std::string& name) { return name.starts_with(begin); };
  return std::ranges::count_if(names, begins) == 1 ? *std::ranges::find_if(names, begins)
                                                   : std::string();
}

/// The name of the option that was probably meant. Names are compared without their dashes, which
/// all have in common.
std::string similarOption(const std::string& name, const Words& names) {
  if (name == "runs" && contains(names, "out")) return "out";
  const std::string nearest = nearestWord(name, names);
  return nearest.empty() ? theOneThatBeginsWith(name, names) : nearest;
}

std::string unknownOption(const TypedCommandLine& line, const std::string& word) {
  const ChosenCommand command = chosenCommand(line);
  const std::string option = word.substr(0, word.find('='));
  const std::string name = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  std::string key_name = name;
  std::ranges::replace(key_name, '-', '_');
  std::string key;
  if (line.words.key_meant_by != nullptr && takesKeys(*command.app)) {
    key = line.words.key_meant_by(key_name);
  }
  const std::string similar = similarOption(name, optionNames(*command.app));
  std::string meant;
  if (!key.empty() && (key == key_name || similar.empty())) {
    meant = "--set " + key + "=" + valueAfter(word, line.typed);
  } else if (!similar.empty()) {
    meant = "--" + similar;
  }
  return fmt::format(
      "{}: no such option of `{}`; {}", option, command.name,
      meant.empty() ? command.name + " --help lists them" : "did you mean " + meant + "?");
}

std::string unknownWord(const TypedCommandLine& line, const std::string& word) {
  const ChosenCommand command = chosenCommand(line);
  const Words arguments = argumentNames(*command.app);
  std::string meant;
  if (contains(optionNames(*command.app), word)) meant = "--" + word;
  if (word.find('=') != std::string::npos && takesKeys(*command.app)) meant = "--set " + word;
  return fmt::format(
      "found \"{}\", but `{}` takes {}; {}", word, command.name,
      arguments.empty() ? std::string("options only")
                        : fmt::format("nothing after {}", fmt::join(arguments, " ")),
      meant.empty() ? command.name + " --help lists its options" : "did you mean " + meant + "?");
}

/// The option of the chosen command, or of one around it, that a word names: "--out",
/// "--out=there".
const CLI::Option* optionNamed(const TypedCommandLine& line, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (!looksLikeOption(name)) return nullptr;
  const CLI::App* command = &line.app;
  const CLI::Option* named = command->get_option_no_throw(name);
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    if (const CLI::Option* inner = command->get_option_no_throw(name)) named = inner;
  }
  return named;
}

/// The type of an option in words; CLI11 writes "INT", and after a colon what a check expects.
std::string typeInWords(const CLI::Option& option) {
  if (option.get_items_expected_min() == 0) return "true or false";
  const std::string full = option.get_type_name();
  const std::string type = full.substr(0, full.find(':'));
  if (type == "INT") return "a whole number";
  if (type == "UINT") return "a whole number from 0";
  if (type == "FLOAT") return "a number";
  return full;
}

/// Replaces the first occurrence of a name that is a word of its own.
void replaceName(std::string& text, const std::string& name, const std::string& by) {
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool begins = at == 0 || text[at - 1] == ' ';
    const bool ends = end == text.size() || text[end] == ' ' || text[end] == ':';
    if (!begins || !ends) continue;
    text.replace(at, name.size(), by);
    return;
  }
}

}  // namespace

bool hasUnknownOption(const TypedCommandLine& line) {
  return std::ranges::any_of(line.app.remaining(true), looksLikeOption);
}

std::string unknownArgument(const TypedCommandLine& line) {
  const Words left = line.app.remaining(true);
  if (left.empty()) return {};
  const auto firstOf = [&left, &line](bool option) -> std::string {
    for (const std::string& word : line.typed) {
      if (contains(left, word) && looksLikeOption(word) == option) return word;
    }
    return {};
  };
  if (const std::string option = firstOf(true); !option.empty()) return unknownOption(line, option);
  const std::string word = firstOf(false);
  return unknownWord(line, word.empty() ? left.front() : word);
}

std::string missingCommand(const TypedCommandLine& line) {
  const ChosenCommand command = chosenCommand(line);
  if (command.app->get_require_subcommand_min() == 0) return {};
  Words known;
  for (const CLI::App* each : command.app->get_subcommands([](const CLI::App* candidate) {
         return !candidate->get_group().empty();  // hidden commands have no group
       })) {
    known.push_back(each->get_name());
  }
  const Words rest = line.app.remaining(true);
  const bool is_inner = command.app != &line.app;
  return fmt::format("{}found {}, expected one of {}; {} --help says what each does{}",
                     is_inner ? command.name.substr(line.words.name.size() + 1) + ": " : "",
                     rest.empty() ? "no command" : "\"" + rest.front() + "\"",
                     fmt::join(known, ", "), command.name,
                     rest.empty() ? "" : didYouMean(rest.front(), known));
}

std::string repeatedOption(const TypedCommandLine& line) {
  for (const CLI::Option* option : chosenCommand(line).app->get_options()) {
    const bool takes_one = option->get_items_expected_max() == 1;
    if (!takes_one || option->count() < 2) continue;
    const Words names = typedNames(*option, line.typed);
    return fmt::format(
        "{}: found {} values, {}; keep one",
        names.empty() ? option->get_name() : fmt::format("{}", fmt::join(names, "/")),
        option->count(), fmt::join(option->results(), " and "));
  }
  return {};
}

std::string missingValue(const TypedCommandLine& line) {
  const std::string& last = line.typed.back();
  const std::string name = last.substr(0, last.find('='));
  if (!looksLikeOption(name)) return {};
  for (const CLI::Option* option : chosenCommand(line).app->get_options()) {
    if (option->get_items_expected_min() == 0 || !option->check_name(name)) continue;
    return fmt::format("{}: found no value, expected {}", name, option->get_type_name());
  }
  return {};
}

std::string optionTakenForValue(const TypedCommandLine& line) {
  for (std::size_t i = 1; i + 1 < line.typed.size(); ++i) {
    const std::string& word = line.typed[i];
    if (word == "--") break;  // arguments only from here on
    const CLI::Option* option = optionNamed(line, word);
    if (option == nullptr || option->count() == 0) continue;
    if (option->get_items_expected_min() == 0) continue;
    const std::size_t equals = word.find('=');
    if (equals != std::string::npos && equals + 1 < word.size()) continue;  // "--out=there"
    const std::string& next = line.typed[i + 1];
    if (optionNamed(line, next) == nullptr) continue;
    const std::string name = word.substr(0, equals);
    return fmt::format("{}: found no value, expected {}; {}={} if such a value is meant", name,
                       option->get_type_name(), name, next);
  }
  return {};
}

std::string unconvertedValue(const TypedCommandLine& line, std::string_view error) {
  for (const CLI::Option* option : chosenCommand(line).app->get_options()) {
    const std::string name = option->get_name();
    if (error != CLI::ConversionError(name, option->results()).what()) continue;
    const Words names = typedNames(*option, line.typed);
    return fmt::format("{}: found {}, expected {}",
                       names.empty() ? name : fmt::format("{}", fmt::join(names, "/")),
                       fmt::join(option->results(), " "), typeInWords(*option));
  }
  return {};
}

std::string withNamesAsTyped(const TypedCommandLine& line, std::string error) {
  for (const CLI::Option* option : chosenCommand(line).app->get_options()) {
    const std::string name = option->get_name();
    const Words names = typedNames(*option, line.typed);
    if (name.empty() || names.empty() || contains(names, name)) continue;
    replaceName(error, name, fmt::format("{}", fmt::join(names, "/")));
  }
  return error;
}

std::string withHelp(const TypedCommandLine& line, std::string_view error) {
  return fmt::format("{}; {} --help explains it", error, chosenCommand(line).name);
}

}  // namespace lab
