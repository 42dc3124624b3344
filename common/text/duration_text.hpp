/// Remaining times as text.
#pragma once

#include <string>

namespace lab {

/// A remaining time, rounded up: "76 s", "10 min 00 s", "2 h 01 min"; "very long" from 1e9 s.
/// durationText() of format.hpp formats measured durations.
[[nodiscard]] std::string remainingTimeText(double seconds);

}  // namespace lab
