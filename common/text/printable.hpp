/// Texts of others on a terminal.
#pragma once

#include <string>
#include <string_view>

namespace lab {

/// A text that comes from a message, another host or a file, as it may be written on a terminal:
/// there, control characters move the cursor, hide text or change settings. They become "\x1b",
/// characters that reverse the direction of text become "\u202e", and invalid UTF-8 becomes U+FFFD.
/// The result is one line.
[[nodiscard]] std::string printable(std::string_view text);

/// The same for a text of several lines: line ends and tabs stay.
[[nodiscard]] std::string printableLines(std::string_view text);

}  // namespace lab
