/// What came of the calibration of one robot, for people and for files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot_bridge/calibration/motor_fit.hpp"
#include "robot_bridge/calibration/speed_check.hpp"

namespace lab::calibration {

struct MotorReport {
  std::int32_t robot = 0;
  Motors held;  ///< before
  MotorFit fit;
  Motors stored;  ///< what the robot holds now
  SpeedCheck before;
  SpeedCheck after;
  std::string refusal;  ///< not empty: why the robot holds what it held before
};

/// What makes a stored calibration stay: the check after it, less what rounding to whole duties
/// explains.
struct CheckLimits {
  double used_share = 0.75;  ///< of the check's segments, at least
  double speed = 0.015;      ///< [1] at most, or four times the tracker's noise
  double turn = 0.03;        ///< [1] likewise
};

/// Why a check after storing is not passed; empty when it is.
[[nodiscard]] std::string checkRefusal(const SpeedCheck& after, const CheckLimits& limits = {});

/// The lines of a table for people, one robot or refusal a line.
[[nodiscard]] std::string tableHead();
[[nodiscard]] std::string tableLine(const MotorReport& report);

/// calibration/motors.toml: what the robots hold, with standard errors and what the checks said.
[[nodiscard]] std::string motorsFile(const std::vector<MotorReport>& reports);

}  // namespace lab::calibration
