#pragma once

#include <string>

namespace lab::runner {

/// A duration of so many seconds for people: "76 s", "10 min 00 s", "2 h 01 min".
[[nodiscard]] std::string remainingTimeText(double seconds);

}  // namespace lab::runner
