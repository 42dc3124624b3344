#pragma once

#include <string>
#include <string_view>

namespace lab::language {

/// What to call a name with Greek letters: "; write gamma" for the letter of that name, "; write
/// tau_r" for one with an index. Nothing: it has none.
[[nodiscard]] std::string spelledAdvice(std::string_view name);

/// The first Greek letter in a line of UTF-8; empty: there is none.
[[nodiscard]] std::string_view greekLetterIn(std::string_view line);

}  // namespace lab::language
