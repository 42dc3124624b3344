/// TOML texts that may come from others.
#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lab::keys {

/// Names in one key, as in a.b.c = 1 and [a.b.c]; more than any file of the lab has. toml++ limits
/// the depth of arrays and inline tables itself, but handles tables within tables by recursion.
constexpr std::size_t kMostNames = 32;

/// Why a text cannot be read. what() has neither the name of the file nor the place.
class TomlError : public std::runtime_error {
 public:
  /// @param at line and column count from 1; column 0: the whole line
  TomlError(const std::string& what, toml::source_position at)
      : std::runtime_error(what), at_(at) {}

  [[nodiscard]] const toml::source_position& at() const { return at_; }

 private:
  toml::source_position at_;
};

/// Parses a text.
/// @param name of the file, which its nodes remember
/// @throws TomlError if it is no TOML, or a key has more than kMostNames names
[[nodiscard]] toml::table parseToml(std::string_view text, std::string_view name);

}  // namespace lab::keys
