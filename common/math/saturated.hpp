/// Numbers that come from outside, as integers that do not overflow.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>

namespace lab {

/// The whole number next to `value` in the direction of 0, limited to the range of `Integer`; 0 for
/// nan. A cast of a double beyond that range is undefined.
template <std::integral Integer>
[[nodiscard]] constexpr Integer saturated(double value) {
  constexpr Integer kLowest = std::numeric_limits<Integer>::min();
  constexpr Integer kHighest = std::numeric_limits<Integer>::max();
  if (value != value) return 0;
  if (value <= static_cast<double>(kLowest)) return kLowest;
  // The highest 64-bit numbers are no doubles: the next one is above the range.
  if (value >= static_cast<double>(kHighest)) return kHighest;
  return static_cast<Integer>(value);
}

/// a + b, at most `most`: of counts that come from outside.
/// @param a, b  not negative
[[nodiscard]] constexpr std::int64_t limitedSum(std::int64_t a, std::int64_t b, std::int64_t most) {
  std::int64_t sum = 0;
  return __builtin_add_overflow(a, b, &sum) || sum > most ? most : sum;
}

/// a - b, limited to what fits: of numbers that come from outside.
[[nodiscard]] constexpr std::int64_t saturatedDifference(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (!__builtin_sub_overflow(a, b, &difference)) return difference;
  return a < b ? std::numeric_limits<std::int64_t>::min()
               : std::numeric_limits<std::int64_t>::max();
}

}  // namespace lab
