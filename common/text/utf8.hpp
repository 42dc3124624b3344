/// Repair of texts that are not valid UTF-8, and their beginning. Own code, because
/// utf8::replace_invalid() of utfcpp writes one U+FFFD for a sequence such as E0 80 80, where the
/// Unicode standard has three.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lab {

/// Replaces invalid bytes by U+FFFD, one for each maximal subpart of an ill-formed sequence
/// (Unicode 15, 3.9, "U+FFFD Substitution of Maximal Subparts"). Valid text is not copied.
void repairUtf8(std::string& text);

/// The beginning of a text of any length, of at most `most` bytes. It ends between two characters.
[[nodiscard]] std::string_view utf8Prefix(std::string_view text, std::size_t most);

}  // namespace lab
