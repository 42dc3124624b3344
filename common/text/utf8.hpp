#pragma once

#include <string>

namespace lab {

/// Makes valid UTF-8 of any bytes: what is none becomes U+FFFD, one for each longest piece that
/// could have begun a character (Unicode 15, 3.9, "U+FFFD Substitution of Maximal Subparts"). Text
/// that is valid stays where it is.
void repairUtf8(std::string& text);

}  // namespace lab
