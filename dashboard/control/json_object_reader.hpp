/// Reads JSON objects that have exactly the expected keys.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

/// Says what was found and what was expected.
class JsonObjectError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Each expected key is read once; finish() then refuses objects with other keys.
class JsonObjectReader {
 public:
  /// @throws JsonObjectError if the text is not a JSON object, is nested too deeply, or has a key
  ///         twice
  explicit JsonObjectReader(std::string_view text);

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

  // All of these throw JsonObjectError if the key is missing or its value is not as expected.

  /// A UTF-8 text without control characters, of at most `max_length` characters.
  [[nodiscard]] std::string text(const char* key, std::size_t max_length);
  /// A number from `low` to `high`, both included.
  [[nodiscard]] double number(const char* key, double low, double high);
  [[nodiscard]] bool flag(const char* key);
  /// An array of at most `max_count` texts.
  [[nodiscard]] std::vector<std::string> texts(const char* key, std::size_t max_count,
                                               std::size_t max_length);
  /// @throws JsonObjectError if the object has keys that were not read
  void finish() const;

 private:
  const nlohmann::json& at(const char* key, const char* expected);

  nlohmann::json json_;
  std::vector<std::string> known_;
};

}  // namespace lab::dashboard
