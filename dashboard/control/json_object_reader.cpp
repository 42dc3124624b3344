#include "dashboard/control/json_object_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace lab::dashboard {
namespace {

constexpr int kMaxDepth = 3;

std::string checkedText(const nlohmann::json& value, const std::string& where,
                        std::size_t max_length) {
  if (!value.is_string()) {
    throw JsonObjectError(fmt::format("{}: found {}, expected a text", where, value.type_name()));
  }
  const auto& text = value.get_ref<const std::string&>();
  // In UTF-8 every byte except 10xxxxxx begins a character.
  const auto length = static_cast<std::size_t>(
      std::ranges::count_if(text, [](unsigned char byte) { return (byte & 0xc0) != 0x80; }));
  if (length > max_length) {
    throw JsonObjectError(
        fmt::format("{}: found {} characters, expected at most {}", where, length, max_length));
  }
  const auto is_control = [](unsigned char letter) { return letter < ' ' || letter == 0x7f; };
  if (std::ranges::any_of(text, is_control)) {
    throw JsonObjectError(where + ": found a control character, expected one line of text");
  }
  return text;
}

}  // namespace

JsonObjectReader::JsonObjectReader(std::string_view text) {
  // The parser would take a zero byte for the end of the text and ignore what follows.
  if (text.find('\0') != std::string_view::npos)
    throw JsonObjectError("found a zero byte, expected JSON");
  std::set<std::string> keys;
  const auto check = [&keys](int depth, nlohmann::json::parse_event_t event,
                             const nlohmann::json& parsed) {
    if (depth > kMaxDepth) throw JsonObjectError("found deeply nested JSON, expected one object");
    if (event == nlohmann::json::parse_event_t::key && depth == 1 &&
        !keys.insert(parsed.get<std::string>()).second) {
      throw JsonObjectError(fmt::format("found {} twice, expected it once", parsed.dump()));
    }
    return true;
  };
  try {
    json_ = nlohmann::json::parse(text, check);
  } catch (const nlohmann::json::exception& error) {
    throw JsonObjectError(fmt::format("found invalid JSON (byte {})", [&] {
      const auto* parse = dynamic_cast<const nlohmann::json::parse_error*>(&error);
      return parse ? parse->byte : 0;
    }()));
  }
  if (!json_.is_object()) {
    throw JsonObjectError(fmt::format("found {}, expected a JSON object", json_.type_name()));
  }
}

const nlohmann::json& JsonObjectReader::at(const char* key, const char* expected) {
  known_.emplace_back(key);
  const auto found = json_.find(key);
  if (found == json_.end())
    throw JsonObjectError(fmt::format("{}: missing, expected {}", key, expected));
  return *found;
}

std::string JsonObjectReader::text(const char* key, std::size_t max_length) {
  return checkedText(at(key, "a text"), key, max_length);
}

double JsonObjectReader::number(const char* key, double low, double high) {
  const nlohmann::json& value = at(key, "a number");
  if (!value.is_number()) {
    throw JsonObjectError(fmt::format("{}: found {}, expected a number from {} to {}", key,
                                      value.type_name(), low, high));
  }
  const auto found = value.get<double>();
  if (!(found >= low && found <= high)) {  // also refuses nan
    throw JsonObjectError(
        fmt::format("{}: found {}, expected a number from {} to {}", key, found, low, high));
  }
  return found;
}

bool JsonObjectReader::flag(const char* key) {
  const nlohmann::json& value = at(key, "true or false");
  if (!value.is_boolean()) {
    throw JsonObjectError(
        fmt::format("{}: found {}, expected true or false", key, value.type_name()));
  }
  return value.get<bool>();
}

std::vector<std::string> JsonObjectReader::texts(const char* key, std::size_t max_count,
                                                 std::size_t max_length) {
  const nlohmann::json& value = at(key, "a list of texts");
  if (!value.is_array() || value.size() > max_count) {
    throw JsonObjectError(fmt::format("{}: expected a list of at most {} texts", key, max_count));
  }
  std::vector<std::string> all;
  for (const nlohmann::json& one : value) all.push_back(checkedText(one, key, max_length));
  return all;
}

void JsonObjectReader::finish() const {
  for (const auto& [key, value] : json_.items()) {
    if (std::ranges::find(known_, key) == known_.end()) {
      throw JsonObjectError(fmt::format("found the key {}, expected only {}",
                                        nlohmann::json(key).dump(), fmt::join(known_, ", ")));
    }
  }
}

}  // namespace lab::dashboard
