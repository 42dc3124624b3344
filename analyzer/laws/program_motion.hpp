/// The free motion of a program of motion, executed as on the robot.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "analyzer/laws/law.hpp"
#include "robot/dynamics/byte_code.hpp"

namespace lab::analysis {

/// What of a robot's body its motion depends on.
struct RobotBody {
  double wheel_base = 0.075;      ///< m.
  double max_wheel_speed = 0.27;  ///< m/s.
  bool pwm_steps = false;         ///< Wheel speeds are rounded to the 256 levels of the motors.
  double clock_error = 0;         ///< [1] Standard deviation of the robots' clock rates.
  double sensor_period = 0.02;    ///< s, between two looks at the condition of a hold.

  bool operator==(const RobotBody&) const = default;
};

using ByteCode = std::shared_ptr<const std::vector<std::uint8_t>>;

/// Whether the byte code, which must be valid, reads an input.
[[nodiscard]] bool readsInput(const std::vector<std::uint8_t>& code, dynamics::Input input);

/// A robot from the start of its program on. Wheels, clock and machine are those of the robot; all
/// sensors read 0. Each motion has a clock rate of its own.
[[nodiscard]] std::unique_ptr<Motion> programMotion(const ByteCode& code, const RobotBody& body);

/// What the first thousands of holds of a program tell.
struct HoldFacts {
  double mean = 0;  ///< Mean duration, s; infinite: one has no end.
  /// The relative variance of the mean squared turning rate over a time T is this time over T, s,
  /// if holds are independent.
  double turning_scatter = 0;
  /// The duration of every hold, s, if it is always the same; else 0.
  double constant = 0;
};
[[nodiscard]] HoldFacts holdFacts(const ByteCode& code, const RobotBody& body);

/// What the steps of the motors change in the speed, by the first thousands of holds of a program.
struct SpeedSteps {
  double relative = 0;  ///< Change of the mean speed, of this speed.
  double sigma = 0;     ///< Standard error of `relative`.
  /// The variance of the mean speed over a time T by the draws of holds is this over T, m^2/s.
  double scatter = 0;
};
[[nodiscard]] SpeedSteps speedSteps(const ByteCode& code, const RobotBody& body);

}  // namespace lab::analysis
