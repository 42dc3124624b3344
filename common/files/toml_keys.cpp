#include "common/files/toml_keys.hpp"

#include <algorithm>

namespace lab::keys {
namespace {

constexpr std::string_view kEndsKey = "\n=,[]{}";

/// The position after the string that begins at `at`; the end of the text if it is not closed.
std::size_t afterString(std::string_view toml, std::size_t at) {
  const char quote = toml[at];
  const bool many_lines = toml.substr(at, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''");
  const std::size_t width = many_lines ? 3 : 1;
  for (std::size_t i = at + width; i < toml.size(); ++i) {
    if (toml[i] == '\\' && quote == '"') {
      ++i;
    } else if (toml[i] == quote && toml.substr(i, width) == toml.substr(at, width)) {
      return i + width;
    } else if (toml[i] == '\n' && !many_lines) {
      return i;
    }
  }
  return toml.size();
}

}  // namespace

std::size_t lineOfDeepKey(std::string_view toml) {
  std::size_t line = 1;
  std::size_t names = 1;
  for (std::size_t i = 0; i < toml.size();) {
    const char letter = toml[i];
    std::size_t next = i + 1;
    if (letter == '#') {
      next = std::min(toml.find('\n', i), toml.size());
    } else if (letter == '"' || letter == '\'') {
      next = afterString(toml, i);
    } else if (letter == '.') {
      if (++names > kMostNames) return line;
    } else if (kEndsKey.find(letter) != std::string_view::npos) {
      names = 1;
    }
    for (; i < next; ++i) {
      if (toml[i] == '\n') ++line;
    }
  }
  return 0;
}

}  // namespace lab::keys
