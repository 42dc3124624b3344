#pragma once

#include <stdint.h>

namespace lab {
namespace firmware {

/// Whether an instant has come, on a clock that wraps around.
inline bool reached(uint32_t now_ms, uint32_t due_ms) {
  return static_cast<int32_t>(now_ms - due_ms) >= 0;
}

}  // namespace firmware
}  // namespace lab
