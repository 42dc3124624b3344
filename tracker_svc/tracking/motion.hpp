/// How a robot on two wheels may have moved since it was last seen.
#pragma once

#include <array>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "tracker_svc/tracking/wheel_log.hpp"

namespace lab::tracker {

/// What the motion model assumes of every robot.
struct MotionSettings {
  double wheel_base = 0.075;      ///< [m]
  double max_wheel_speed = 0.27;  ///< [m/s]
};

/// Both wheels: ways [m] or speeds [m/s].
struct Wheels {
  double left = 0;
  double right = 0;
};

/// The ways of the wheels that lead from one pose to another along one arc.
[[nodiscard]] Wheels wheelsBetween(const dynamics::Pose& from, const dynamics::Pose& to,
                                   double wheel_base);

/// @return the angle in (-pi, pi]
[[nodiscard]] double wrapped(double angle);

/// Where a robot that moved freely would be now.
struct Reckoning {
  dynamics::Pose pose;
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  double known = 0;                    ///< [s] how much of the time the robot's reports cover
  double assumed = 0;                  ///< [s] and how much they do not
  double travel = 0;                   ///< [m] length of the way
};

/// Dead reckoning. Where the robot's reports (null: none) do not say otherwise, the wheels go on as
/// they did and come to rest over kMemory, as programs draw new speeds every half second or so.
class DeadReckoner {
 public:
  explicit DeadReckoner(const MotionSettings& settings) : settings_(settings) {}

  [[nodiscard]] Reckoning reckon(const dynamics::Pose& from,
                                 const std::array<double, 6>& covariance, Wheels speeds,
                                 const WheelLog* reports, double begin, double end);

  /// [s] How long wheels are believed to keep their speeds.
  static constexpr double kMemory = 0.5;
  /// [1] Standard deviation of the gain of a wheel, constant for a robot.
  static constexpr double kGainError = 0.04;

 private:
  MotionSettings settings_;
  std::vector<WheelSegment> segments_;
};

}  // namespace lab::tracker
