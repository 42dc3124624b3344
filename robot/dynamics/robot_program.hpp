#pragma once

#include <string>

#include "robot/dynamics/program.hpp"

namespace lab {
namespace dynamics {

/// A program in physical parameters (SI). A kind ignores the parameters that it is not listed for.
/// Host only.
struct RobotProgram {
  ProgramKind kind = kNone;
  double v = 0;            ///< Speed [m/s] (ABP, RTP); negative drives backward.
  double va = 0;           ///< Mean speed [m/s] (noisy ABP; must be 0 for BP).
  double V = 0;            ///< Half width of the wheel speeds' range [m/s] (noisy ABP, BP).
  double epsilon = 0;      ///< Time between draws [s] (ABP, noisy ABP, BP).
  double eta = 0;          ///< Largest rotation rate [rad/s] (ABP).
  double gamma = 0;        ///< Tumbling rate [1/s] (RTP).
  double tau_t = 0;        ///< Duration of a tumble [s] (RTP).
  double wheel_left = 0;   ///< Left wheel [m/s] (constant wheel speeds).
  double wheel_right = 0;  ///< Right wheel [m/s] (constant wheel speeds).

  bool operator==(const RobotProgram&) const = default;
};

/// What the wheels can do (paper, "Robot model").
struct WheelLimits {
  double v_max = 0.27;        ///< Maximum wheel speed [m/s].
  double wheel_base = 0.075;  ///< d, the distance between the wheels [m].
};

/// Either the robot's integers or the reason why the robot cannot run the program.
struct ParamsResult {
  bool ok = false;
  ProgramParams params;
  std::string reason;  ///< One line: the physical quantity, what was found, what is allowed.
};

/// Why no robot with these wheels can run the program: the physical quantity, what was found, what
/// is allowed. Empty if it can.
[[nodiscard]] std::string outOfRange(const RobotProgram& physics,
                                     const WheelLimits& limits = WheelLimits());

/// Converts and validates. Times are rounded to the nearest millisecond and speeds to the nearest
/// micrometre/s; see toRobotProgram for what is then executed.
[[nodiscard]] ParamsResult toProgramParams(const RobotProgram& program,
                                           const WheelLimits& limits = WheelLimits());

/// The physical parameters that the robot executes, after rounding.
[[nodiscard]] RobotProgram toRobotProgram(const ProgramParams& params,
                                          const WheelLimits& limits = WheelLimits());

}  // namespace dynamics
}  // namespace lab
