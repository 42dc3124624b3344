#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// The fastest a wheel turns at full duty: 27 cm/s (paper, "Robot model").
constexpr int32_t kMaxWheelUmS = 270000L;
/// The largest duty of the 8-bit pulse width modulation; one step is 27 cm/s / 255 = 1.06 mm/s.
constexpr int16_t kMaxDuty = 255;

/// Limits a wheel speed to [-max, max]; sets `saturated` if it had to, and leaves it otherwise.
inline int32_t clampWheel(int32_t um_s, int32_t max_um_s, bool& saturated) {
  if (um_s > max_um_s) {
    saturated = true;
    return max_um_s;
  }
  if (um_s < -max_um_s) {
    saturated = true;
    return -max_um_s;
  }
  return um_s;
}

/// The signed duty -255..255 for a wheel speed, rounded to NEAREST (half away from zero):
/// truncating instead lowers D_r by 1.3 % and the diffusion of a slow Brownian program by 5 %.
inline int16_t dutyForSpeed(int32_t um_s, int32_t max_um_s) {
  const uint32_t max = static_cast<uint32_t>(max_um_s);
  uint32_t size = static_cast<uint32_t>(um_s < 0 ? -um_s : um_s);
  if (size > max) {
    size = max;
  }
  const int16_t duty =
      static_cast<int16_t>((size * static_cast<uint32_t>(kMaxDuty) + max / 2U) / max);
  return um_s < 0 ? static_cast<int16_t>(-duty) : duty;
}

}  // namespace dynamics
}  // namespace lab
