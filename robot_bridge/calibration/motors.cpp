#include "robot_bridge/calibration/motors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robot/dynamics/motor.hpp"

namespace lab::calibration {
namespace {

constexpr double kMicro = 1e-6;

Wheel storable(const Wheel& wheel) {
  const double band = std::round(std::max(0.0, wheel.dead_band) * dynamics::kMaxDuty);
  return {std::round(wheel.gain / kMicro) * kMicro, band / dynamics::kMaxDuty};
}

}  // namespace

double wheelSpeed(const Wheel& wheel, double duty, double max) {
  const double above = std::fabs(duty) - wheel.dead_band;
  if (duty == 0 || above <= 0) return 0;
  return std::copysign(max * wheel.gain * above / (1 - wheel.dead_band), duty);
}

Motion motionOf(double left, double right, double wheel_base) {
  return {(left + right) / 2, (right - left) / wheel_base};
}

Motion motionOf(const Motors& motors, double duty_left, double duty_right, double max) {
  return motionOf(wheelSpeed(motors.left, duty_left, max),
                  wheelSpeed(motors.right, duty_right, max), motors.wheel_base);
}

double dutyFor(const Wheel& stored, double speed, double max, bool steps) {
  const auto um_s = static_cast<std::int32_t>(std::lround(speed / kMicro));
  if (steps) {
    const dynamics::WheelCalibration wheel{
        static_cast<std::int32_t>(std::lround(stored.gain / kMicro)),
        static_cast<std::uint8_t>(std::lround(stored.dead_band * dynamics::kMaxDuty))};
    const auto max_um_s = static_cast<std::int32_t>(std::lround(max / kMicro));
    return static_cast<double>(dynamics::dutyForSpeed(um_s, max_um_s, wheel)) / dynamics::kMaxDuty;
  }
  if (um_s == 0) return 0;
  const double share = std::min(1.0, std::fabs(speed) / (max * stored.gain));
  return std::copysign(stored.dead_band + (1 - stored.dead_band) * share, speed);
}

Motors storable(const Motors& motors) {
  return {storable(motors.left), storable(motors.right),
          std::round(motors.wheel_base / kMicro) * kMicro};
}

}  // namespace lab::calibration
