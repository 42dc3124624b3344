#include "common/text/duration_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "common/math/saturated.hpp"

namespace lab {

std::string remainingTimeText(double seconds) {
  constexpr double kLongest = 1e9;  // [s]
  if (!(seconds < kLongest)) return "very long";
  const auto whole = saturated<std::int64_t>(std::ceil(seconds));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace lab
