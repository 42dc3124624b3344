#include "common/files/toml_document.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>

#include "common/files/experiment_error.hpp"
#include "common/files/file_values.hpp"
#include "common/files/toml_text.hpp"
#include "robot/language/spelled_name.hpp"

namespace lab::keys {
namespace {

constexpr std::string_view kSet = "--set ";
constexpr std::size_t kMostShown = 60;
constexpr std::string_view kBareLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";

using Part = std::variant<std::string, std::size_t>;
using Path = std::vector<Part>;

bool isBare(std::string_view key) {
  return !key.empty() && key.find_first_not_of(kBareLetters) == std::string_view::npos;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Removes "[2]" from the beginning of the text and returns the index; nothing if it is malformed.
std::optional<std::size_t> takeIndex(std::string_view& text) {
  std::size_t index = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + 1, end, index);
  if (read.ec != std::errc() || read.ptr == end || *read.ptr != ']') return {};
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()) + 1);
  return index;
}

/// Parses a path such as a.b[2].c; nothing if it is malformed.
std::optional<Path> parsePath(std::string_view text) {
  Path path;
  while (true) {
    const std::size_t length = std::min(text.find_first_of(".["), text.size());
    if (!isBare(text.substr(0, length))) return {};
    path.emplace_back(std::string(text.substr(0, length)));
    text.remove_prefix(length);
    while (text.starts_with('[')) {
      const auto index = takeIndex(text);
      if (!index) return {};
      path.emplace_back(*index);
    }
    if (text.empty()) return path;
    if (!text.starts_with('.')) return {};
    text.remove_prefix(1);
  }
}

template <typename Node>
Node* child(Node* node, const Part& part) {
  if (const auto* key = std::get_if<std::string>(&part)) {
    return node->is_table() ? node->as_table()->get(*key) : nullptr;
  }
  return node->is_array() ? node->as_array()->get(std::get<std::size_t>(part)) : nullptr;
}

[[noreturn]] void refuse(const std::string& source, const std::string& why) {
  throw ExperimentError({source + ": " + why});
}

/// Parses a value as TOML, or takes it as a text if it is no TOML.
/// @param source names it in messages
toml::table parseValue(const std::string& value, const std::string& source) {
  for (const std::string& candidate : {value, tomlString(value)}) {
    try {
      toml::table table = parseToml("value = " + candidate, source);
      if (table.size() == 1) return table;
    } catch (const TomlError&) {
      continue;  // not TOML: a bare word
    }
  }
  refuse(source, "found bytes that are no text, allowed UTF-8");
}

/// What is wrong with a Greek letter where a key was expected; empty: there is none.
std::string greekNameAt(std::string_view text, const toml::source_position& at) {
  for (toml::source_index line = 1; line < at.line; ++line) {
    text.remove_prefix(std::min(text.size(), text.find('\n') + 1));
  }
  const std::string_view line = text.substr(0, text.find('\n'));
  const auto is_further_byte = [](char c) { return (static_cast<unsigned char>(c) >> 6) == 2; };
  std::size_t letter = 0;
  for (toml::source_index column = 1; column < at.column && letter < line.size(); ++column) {
    ++letter;
    while (letter < line.size() && is_further_byte(line[letter])) ++letter;
  }
  if (letter >= line.size() || language::greekLetterIn(line.substr(letter, 2)).empty()) return {};
  const auto in_name = [](char c) {
    return kBareLetters.find(c) != std::string_view::npos || static_cast<unsigned char>(c) >= 0x80;
  };
  std::size_t begin = letter;
  std::size_t end = letter;
  while (begin > 0 && in_name(line[begin - 1])) --begin;
  while (end < line.size() && in_name(line[end])) ++end;
  const std::string_view name = line.substr(begin, end - begin);
  return "found the name " + std::string(name) + ", allowed letters a to z, digits and _" +
         language::spelledAdvice(name);
}

}  // namespace

TomlDocument::TomlDocument(std::string_view text, std::string file,
                           const std::vector<std::string>& overrides)
    : file_(std::move(file)) {
  try {
    root_ = parseToml(text, file_);
  } catch (const TomlError& error) {
    const toml::source_position at = error.at();
    const std::string line = file_ + ":" + std::to_string(at.line) + ":";
    if (at.column == 0) throw ExperimentError({line + " " + error.what()});
    const std::string greek = greekNameAt(text, at);
    throw ExperimentError(
        {line + std::to_string(at.column) + ": " + (greek.empty() ? error.what() : greek)});
  }
  std::vector<std::string> problems;
  for (const std::string& argument : overrides) {
    try {
      apply(argument);
    } catch (const ExperimentError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  if (!problems.empty()) throw ExperimentError(std::move(problems));
}

void TomlDocument::apply(const std::string& argument) {
  const std::string source = std::string(kSet) + argument;
  const std::size_t equals = argument.find('=');
  const std::string key = trimmed(argument.substr(0, equals));
  if (equals == std::string::npos) {
    refuse(source, "found no value, allowed --set key=value, as in --set duration_s=60");
  }
  const auto path = parsePath(key);
  if (!path) {
    refuse(source, "found the key \"" + key + "\", allowed a path as in robots[0].x_cm");
  }
  if (path->size() > kMostNames) {
    refuse(std::string(kSet) + source.substr(kSet.size(), kMostShown) + "...",
           "found a path of " + std::to_string(path->size()) + " names, allowed at most " +
               std::to_string(kMostNames));
  }
  toml::table parsed = parseValue(argument.substr(equals + 1), source);
  toml::node* place = &root_;
  for (auto part = path->begin(); part + 1 != path->end(); ++part) {
    toml::node* next = child(place, *part);
    const auto* name = std::get_if<std::string>(&*part);
    if (next == nullptr && name != nullptr && place->is_table() &&
        std::holds_alternative<std::string>(*(part + 1))) {
      toml::table made = toml::parse("value = {}", source);
      next =
          &place->as_table()->insert_or_assign(*name, std::move(*made.get("value"))).first->second;
    }
    if (next == nullptr) refuse(source, "found no such place in the file, allowed a path to a key");
    place = next;
  }
  toml::node&& value = std::move(*parsed.get("value"));
  if (const auto* name = std::get_if<std::string>(&path->back()); name && place->is_table()) {
    place->as_table()->insert_or_assign(*name, std::move(value));
    return;
  }
  const auto* index = std::get_if<std::size_t>(&path->back());
  toml::array* array = place->as_array();
  if (index == nullptr || array == nullptr || *index >= array->size()) {
    refuse(source, "found no such place in the file, allowed a path to a key");
  }
  array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*index), std::move(value));
}

FileLocation TomlDocument::placeOf(const toml::source_region& source) const {
  if (source.path && source.path->starts_with(kSet)) return {*source.path, 0};
  const std::size_t line = source.begin.line;
  return {line == 0 ? file_ : file_ + ":" + std::to_string(line), line};
}

FileLocation TomlDocument::place(const toml::node& node) const { return placeOf(node.source()); }

FileLocation TomlDocument::place(const toml::key& key, const toml::node& node) const {
  return placeOf(key.source().begin ? key.source() : node.source());
}

FileLocation TomlDocument::place(const std::string& path) const {
  const toml::node* node = &root_;
  for (const Part& part : parsePath(path).value_or(Path{})) {
    const toml::node* next = child(node, part);
    if (next == nullptr) break;
    node = next;
  }
  return place(*node);
}

std::string displayText(std::string_view text) {
  std::string cut(text.substr(0, kMostShown));
  for (char& letter : cut) {
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  }
  return '"' + cut + (text.size() > kMostShown ? "...\"" : "\"");
}

std::string displayText(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return displayText(std::string_view(node.ref<std::string>()));
    case toml::node_type::integer:
      return std::to_string(node.ref<std::int64_t>());
    case toml::node_type::floating_point:
      return numberText(node.ref<double>());
    case toml::node_type::boolean:
      return node.ref<bool>() ? "true" : "false";
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    default:
      return "a date or time";
  }
}

std::string displayKey(std::string_view key) {
  return isBare(key) ? std::string(key) : displayText(key);
}

}  // namespace lab::keys
