/// A JSON object of which nothing may be missing and nothing be too much.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

/// What was found and what was expected.
class JsonObjectError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Each key is asked for once; finish() then says whether others were there.
class JsonObjectReader {
 public:
  /// @throws JsonObjectError when the text is no JSON object, or a deep one, or names a key twice.
  explicit JsonObjectReader(std::string_view text);

  // All throw JsonObjectError.

  /// UTF-8 without control characters, of at most `most` characters.
  [[nodiscard]] std::string text(const char* key, std::size_t most);
  [[nodiscard]] double number(const char* key, double low, double high);
  [[nodiscard]] bool flag(const char* key);
  [[nodiscard]] std::vector<std::string> texts(const char* key, std::size_t count,
                                               std::size_t most);
  void finish() const;

 private:
  const nlohmann::json& at(const char* key, const char* expected);

  nlohmann::json json_;
  std::vector<std::string> known_;
};

}  // namespace lab::dashboard
