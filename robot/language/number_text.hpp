/// Numbers in messages.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <initializer_list>
#include <string>

namespace lab::language {

/// With so many digits numbers are written exactly.
constexpr int kExactDigits = 16;

/// Rounded to significant digits, without trailing zeros; from kExactDigits on the shortest text
/// that gives the same number again.
[[nodiscard]] inline std::string numberText(double value, int digits = 4) {
  std::array<char, 40> text{};
  if (digits < kExactDigits) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return text.data();
  }
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), written.ptr};
}

/// The digits, at least `fewest`, with which a number does not look like one of the bounds that it
/// differs from.
[[nodiscard]] inline int digitsBeside(std::initializer_list<double> bounds, double value,
                                      int fewest = 4) {
  int digits = fewest;
  const auto looks_like = [&](double bound) {
    return value != bound && numberText(value, digits) == numberText(bound, digits);
  };
  while (digits < kExactDigits && std::ranges::any_of(bounds, looks_like)) ++digits;
  return digits;
}

}  // namespace lab::language
