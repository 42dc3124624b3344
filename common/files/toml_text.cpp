#include "common/files/toml_text.hpp"

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
      // A text of many lines may end with one or two quotes of its own before the three.
      const std::size_t latest = std::min(i + width + (many_lines ? 2 : 0), toml.size());
      for (i += width; i < latest && toml[i] == quote;) ++i;
      return i;
    } else if (toml[i] == '\n' && !many_lines) {
      return i;
    }
  }
  return toml.size();
}

/// The line of the first key of more than kMostNames names; 0: there is no such key.
toml::source_index lineOfDeepKey(std::string_view toml) {
  toml::source_index line = 1;
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

}  // namespace

toml::table parseToml(std::string_view text, std::string_view name) {
  if (const toml::source_index line = lineOfDeepKey(text); line > 0) {
    throw TomlError("found a key of more than " + std::to_string(kMostNames) +
                        " names, which no file of the lab has",
                    {line, 0});
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw TomlError("found no valid TOML: " + std::string(error.description()) +
                        "; allowed: TOML 1.0 (docs/experiments.md)",
                    error.source().begin);
  }
}

}  // namespace lab::keys
