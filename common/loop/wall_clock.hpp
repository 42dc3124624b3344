/// What the computer's clock says, for what is not on the lab's own.
#pragma once

#include <chrono>
#include <cstdint>

namespace lab::runner {

/// Microseconds since 1970.
[[nodiscard]] inline std::int64_t wallClock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace lab::runner
