/// Reports of a calibration of motors, as text and as a file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot_bridge/calibration/motor_fit.hpp"
#include "robot_bridge/calibration/speed_check.hpp"

namespace lab::calibration {

struct MotorReport {
  std::int32_t robot = 0;
  Motors held;  ///< stored in the robot before
  MotorFit fit;
  Motors stored;  ///< stored in the robot now
  SpeedCheck before;
  SpeedCheck after;
  std::string refusal;  ///< why the robot keeps its previous calibration; empty if it does not
};

/// Conditions for keeping a stored calibration: limits for the errors in the check after storing,
/// without the part that rounding to whole duties explains.
struct CheckLimits {
  double used_share = 0.75;  ///< smallest share of segments used
  double speed = 0.015;      ///< [1] largest error, or four times the tracker's noise
  double turn = 0.03;        ///< [1] largest error, or four times the tracker's noise
};

/// Why a check after storing failed; empty if it passed.
[[nodiscard]] std::string checkRefusal(const SpeedCheck& after, const CheckLimits& limits = {});

/// The lines of a text table, one per robot or refusal.
[[nodiscard]] std::string tableHead();
[[nodiscard]] std::string tableLine(const MotorReport& report);

/// The text of calibration/motors.toml: the calibrations in the robots, standard errors, and
/// results of the checks.
[[nodiscard]] std::string motorsFile(const std::vector<MotorReport>& reports);

}  // namespace lab::calibration
