/// Models of a wheel with its motor, and of the electronics that drive it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "robot/dynamics/motor.hpp"

namespace lab::sim {

/// One wheel with motor and driver. The robot does not know these values; `lab calibrate motors`
/// measures them from outside.
struct WheelMotor {
  std::int32_t max_um_s = dynamics::kMaxWheelUmS;  ///< Nominal speed at full duty.
  double gain = 1;                                 ///< Real over nominal speed at full duty.
  double dead_band = 0;  ///< Duty up to which the wheel stands; below 255.

  /// The speed (m/s) at a signed duty of at most 255:
  /// max * gain * (|duty| - dead_band) / (255 - dead_band), 0 within the dead band.
  [[nodiscard]] double speed(double duty) const {
    const double above = std::fabs(duty) - dead_band;
    if (above <= 0) {
      return 0;
    }
    const double speed = above * (max_um_s * 1e-6 / (dynamics::kMaxDuty - dead_band)) * gain;
    return duty < 0 ? -speed : speed;
  }
};

/// The speed (m/s) of a wheel whose electronics command um_s and compensate by `calibration`.
/// @param pwm_steps false: continuous duty instead of 256 levels
[[nodiscard]] inline double drivenSpeed(std::int32_t um_s, const WheelMotor& motor,
                                        const dynamics::WheelCalibration& calibration,
                                        bool pwm_steps) {
  bool saturated = false;
  const std::int32_t commanded = dynamics::clampWheel(um_s, motor.max_um_s, saturated);
  if (pwm_steps) {
    return motor.speed(dynamics::dutyForSpeed(commanded, motor.max_um_s, calibration));
  }
  if (motor.dead_band == 0 && calibration == dynamics::WheelCalibration{}) {
    return commanded * 1e-6 * motor.gain;
  }
  if (commanded == 0) {
    return 0;
  }
  const double full = motor.max_um_s * (calibration.gain_ppm * 1e-6);
  const double share = std::min(1.0, std::abs(commanded) / full);
  const double duty = calibration.dead_band + (dynamics::kMaxDuty - calibration.dead_band) * share;
  return motor.speed(commanded < 0 ? -duty : duty);
}

}  // namespace lab::sim
