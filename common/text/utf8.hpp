/// Repair of texts that are not valid UTF-8. Own code, because utf8::replace_invalid() of utfcpp
/// writes one U+FFFD for a sequence such as E0 80 80, where the Unicode standard has three.
#pragma once

#include <string>

namespace lab {

/// Replaces invalid bytes by U+FFFD, one for each maximal subpart of an ill-formed sequence
/// (Unicode 15, 3.9, "U+FFFD Substitution of Maximal Subparts"). Valid text is not copied.
void repairUtf8(std::string& text);

}  // namespace lab
