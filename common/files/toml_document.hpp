/// A TOML file with its overrides. The only header that sees toml++: include it from .cpp files.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/file_problems.hpp"

namespace lab::keys {

/// A parsed file whose overrides are in place.
class TomlDocument {
 public:
  /// @param file name for the messages.
  /// @param overrides "key=value" each. The key is a path, "robots[0].x_cm"; tables on the way are
  /// made where they are missing. The value is TOML, and text where it is not.
  /// @throws ExperimentError for invalid TOML and for an override that fits nowhere.
  TomlDocument(std::string_view text, std::string file, const std::vector<std::string>& overrides);

  [[nodiscard]] const toml::table& root() const { return root_; }

  /// Where a value stands: its line, or the override that set it.
  [[nodiscard]] FileLocation place(const toml::node& node) const;

  /// Where a key stands: its line, or the override that set its value.
  [[nodiscard]] FileLocation place(const toml::key& key, const toml::node& node) const;

  /// Where the path stands or, if it is not there, what is around it.
  [[nodiscard]] FileLocation place(const std::string& path) const;

 private:
  void apply(const std::string& argument);
  [[nodiscard]] FileLocation placeOf(const toml::source_region& source) const;

  std::string file_;
  toml::table root_;
};

/// A value as a message shows it: cut to some 60 characters, in one line.
[[nodiscard]] std::string shown(const toml::node& node);

/// Text in quotes, cut and in one line.
[[nodiscard]] std::string shown(std::string_view text);

/// A key as it is written in a path: in quotes where it is not bare.
[[nodiscard]] std::string shownKey(std::string_view key);

}  // namespace lab::keys
