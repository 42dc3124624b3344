/// Motion model of a robot on two wheels.
#pragma once

#include <array>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "tracker_svc/tracking/wheel_log.hpp"

namespace lab::tracker {

/// Assumptions about every robot.
struct MotionSettings {
  double wheel_base = 0.075;      ///< [m]
  double max_wheel_speed = 0.27;  ///< [m/s]
};

/// Travels [m] or speeds [m/s] of both wheels.
struct Wheels {
  double left = 0;
  double right = 0;
};

/// Wheel travels that lead from one pose to another along one arc.
[[nodiscard]] Wheels wheelsBetween(const dynamics::Pose& from, const dynamics::Pose& to,
                                   double wheel_base);

/// Expected pose of a robot that moved freely.
struct Reckoning {
  dynamics::Pose pose;
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  double known = 0;                    ///< [s] covered by the robot's reports
  double assumed = 0;                  ///< [s] not covered
  double travel = 0;                   ///< [m] length of the path
};

/// Dead reckoning. Where no reports of the robot (null: none) exist, the wheels keep their speeds
/// and come to rest over kMemory, since programs draw new speeds about every half second.
class DeadReckoner {
 public:
  explicit DeadReckoner(const MotionSettings& settings) : settings_(settings) {}

  [[nodiscard]] Reckoning reckon(const dynamics::Pose& from,
                                 const std::array<double, 6>& covariance, Wheels speeds,
                                 const WheelLog* reports, double begin, double end);

  /// [s] Time constant for which wheels keep their speeds.
  static constexpr double kMemory = 0.5;
  /// [1] Standard deviation of the gain of a wheel, constant for a robot.
  static constexpr double kGainError = 0.04;

 private:
  MotionSettings settings_;
  std::vector<WheelSegment> segments_;
};

}  // namespace lab::tracker
