/// A TOML file with its overrides. Include it only from .cpp files, because toml++ is a large
/// header.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/file_problems.hpp"

namespace lab::keys {

/// A parsed file, after its overrides.
class TomlDocument {
 public:
  /// @param file name, for messages
  /// @param overrides "key=value" each. The key is a path, "robots[0].x_cm"; missing tables on
  ///   the path are created. The value is TOML, or taken as a text if it is not.
  /// @throws ExperimentError for invalid TOML and for a path that does not exist
  TomlDocument(std::string_view text, std::string file, const std::vector<std::string>& overrides);

  [[nodiscard]] const toml::table& root() const { return root_; }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// The location of a value: its line, or the override that set it.
  [[nodiscard]] FileLocation place(const toml::node& node) const;

  /// The location of a key: its line, or the override that set its value.
  [[nodiscard]] FileLocation place(const toml::key& key, const toml::node& node) const;

  /// The location of a path, or of the innermost existing element that contains it.
  [[nodiscard]] FileLocation place(const std::string& path) const;

 private:
  void apply(const std::string& argument);
  [[nodiscard]] FileLocation placeOf(const toml::source_region& source) const;

  std::string file_;
  toml::table root_;
};

/// A value as text for messages: in one line, cut to about 60 characters.
[[nodiscard]] std::string displayText(const toml::node& node);

/// A text for messages: in quotes, in one line, cut to about 60 characters.
[[nodiscard]] std::string displayText(std::string_view text);

/// A key as written in a path: in quotes unless it is a bare key.
[[nodiscard]] std::string displayKey(std::string_view key);

}  // namespace lab::keys
