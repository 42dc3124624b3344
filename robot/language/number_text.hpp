/// Numbers in messages.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace lab::language {

/// Rounded to four significant digits, without trailing zeros.
[[nodiscard]] inline std::string numberText(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

}  // namespace lab::language
