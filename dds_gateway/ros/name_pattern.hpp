/// Regular expressions of the names of topics.
#pragma once

#include <re2/re2.h>

#include <cstddef>
#include <memory>
#include <string>

namespace lab::gateway {

/// A regular expression of whole names (syntax of RE2). Patterns come from files of others: RE2
/// takes a time that is proportional to the name and bounded memory, whatever the pattern.
class NamePattern {
 public:
  static constexpr std::size_t kLongest = 1000;  ///< [bytes] of a pattern

  /// @throws std::invalid_argument if it is too long, or with what RE2 says about it
  explicit NamePattern(const std::string& text);

  [[nodiscard]] bool matches(const std::string& name) const;

  /// Number of its groups.
  [[nodiscard]] std::size_t groups() const;

  /// @param text $1 to $9 stand for the groups of the pattern in `name`, which it matches
  [[nodiscard]] std::string expand(const std::string& text, const std::string& name) const;

 private:
  std::shared_ptr<const re2::RE2> pattern_;
};

/// What follows a $ in `text` that is none of $1 to $`groups`: "$3"; empty: there is no such $.
[[nodiscard]] std::string unknownGroup(const std::string& text, std::size_t groups);

}  // namespace lab::gateway
