#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// Wheel speed at full duty: 27 cm/s (paper, "Robot model").
constexpr int32_t kMaxWheelUmS = 270000L;
/// The largest duty of the 8-bit pulse width modulation; one step is 27 cm/s / 255 = 1.06 mm/s.
constexpr int16_t kMaxDuty = 255;

/// Sum and difference that wrap around instead of overflowing, for speeds that no valid settings
/// contain.
inline int32_t wrappingSum(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}
inline int32_t wrappingDifference(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) - static_cast<uint32_t>(b));
}

/// |um_s|, also of the lowest number.
inline uint32_t absoluteSpeed(int32_t um_s) {
  return um_s < 0 ? 0U - static_cast<uint32_t>(um_s) : static_cast<uint32_t>(um_s);
}

/// Limits a wheel speed to [-max, max]; a wheel without speed stands. Sets `saturated` if it
/// changes the speed, and does not change `saturated` otherwise.
inline int32_t clampWheel(int32_t um_s, int32_t max_um_s, bool& saturated) {
  if (max_um_s < 0) {
    max_um_s = 0;
  }
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

/// The signed duty -255..255 for a wheel speed, rounded to nearest (half away from zero).
/// Truncation would lower D_r by 1.3 % and the diffusion of slow wheels without a mean speed by 5
/// %.
inline int16_t dutyForSpeed(int32_t um_s, int32_t max_um_s) {
  if (max_um_s <= 0) {
    return 0;
  }
  const uint32_t max = static_cast<uint32_t>(max_um_s);
  uint32_t size = absoluteSpeed(um_s);
  if (size > max) {
    size = max;
  }
  const int16_t duty =
      static_cast<int16_t>((size * static_cast<uint32_t>(kMaxDuty) + max / 2U) / max);
  return um_s < 0 ? static_cast<int16_t>(-duty) : duty;
}

/// The calibration of one wheel, see `lab calibrate motors`. The wheel stands up to the dead band;
/// above it, its speed is max * gain * (duty - dead_band) / (255 - dead_band).
struct WheelCalibration {
  int32_t gain_ppm = 1000000L;  ///< Actual over nominal speed at full duty, millionths.
  uint8_t dead_band = 0;        ///< Duty.
};

inline bool operator==(const WheelCalibration& a, const WheelCalibration& b) {
  return a.gain_ppm == b.gain_ppm && a.dead_band == b.dead_band;
}

/// The speed of a calibrated wheel at full duty, for a positive nominal one.
inline uint32_t fullSpeed(int32_t max_um_s, const WheelCalibration& wheel) {
  return static_cast<uint32_t>(static_cast<uint64_t>(max_um_s) *
                               static_cast<uint32_t>(wheel.gain_ppm) / 1000000U);
}

/// The signed duty at which a calibrated wheel with this fullSpeed() has the speed um_s, rounded to
/// nearest and limited to 255. Without dead band and with gain 1 it equals
/// dutyForSpeed(um_s, max_um_s).
inline int16_t dutyOfWheel(int32_t um_s, uint32_t full, const WheelCalibration& wheel) {
  const uint32_t size = absoluteSpeed(um_s);
  if (size == 0 || full == 0) {
    return 0;
  }
  const uint32_t range = static_cast<uint32_t>(kMaxDuty) - wheel.dead_band;
  uint32_t duty = static_cast<uint32_t>(kMaxDuty);
  if (size < full) {
    // 5 m/s * 255 fits in 32 bits.
    const uint32_t above = (size * range + full / 2U) / full;
    duty = above == 0 ? 0 : above + wheel.dead_band;
  }
  const int16_t result = static_cast<int16_t>(duty);
  return um_s < 0 ? static_cast<int16_t>(-result) : result;
}

inline int16_t dutyForSpeed(int32_t um_s, int32_t max_um_s, const WheelCalibration& wheel) {
  return dutyOfWheel(um_s, fullSpeed(max_um_s, wheel), wheel);
}

}  // namespace dynamics
}  // namespace lab
