/// Conversions between Motors and motor_calibration_t.
#pragma once

#include <cstdint>
#include <lab/motor_calibration_t.hpp>

#include "robot_bridge/calibration/motors.hpp"

namespace lab::calibration {

[[nodiscard]] inline motor_calibration_t toMessage(std::int32_t robot, const Motors& motors) {
  motor_calibration_t message{};
  message.robot_id = robot;
  message.gain_left = motors.left.gain;
  message.gain_right = motors.right.gain;
  message.dead_band_left = motors.left.dead_band;
  message.dead_band_right = motors.right.dead_band;
  message.wheel_base = motors.wheel_base;
  return message;
}

[[nodiscard]] inline Motors fromMessage(const motor_calibration_t& message) {
  return {{message.gain_left, message.dead_band_left},
          {message.gain_right, message.dead_band_right},
          message.wheel_base};
}

}  // namespace lab::calibration
