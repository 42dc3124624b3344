/// The computer's wall clock, for code that has no Loop.
#pragma once

#include <chrono>
#include <cstdint>

namespace lab {

/// Microseconds since 1970.
[[nodiscard]] inline std::int64_t wallClock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace lab
