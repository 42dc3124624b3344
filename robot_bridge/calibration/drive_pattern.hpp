/// What a robot drives to be calibrated, and where it has room for it.
#pragma once

#include <optional>
#include <vector>

#include "robot_bridge/calibration/motors.hpp"

namespace lab::calibration {

/// The wheels keep these speeds for a while.
struct PatternStep {
  double left = 0;      ///< [m/s]
  double right = 0;     ///< [m/s]
  double duration = 0;  ///< [s] beside the time to settle
};

using Pattern = std::vector<PatternStep>;

/// How long a change of the wheels' speeds may take to arrive [s]: poses in this time after an
/// order are not used.
inline constexpr double kSettleTime = 0.15;

/// Both wheels, the wheels against each other, and each wheel alone, there and back, at about 15,
/// 30, 50 and 70 % of full duty: 32 steps, about 40 s, within 14 cm of where it began.
/// @param stored what the robot believes: the speeds are those that it turns into whole duties
[[nodiscard]] Pattern calibrationPattern(const Motors& stored, double max);

/// Other speeds, and arcs, there and back: 12 steps.
[[nodiscard]] Pattern checkPattern(double max);

/// A robot's place.
struct Place {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
};

/// What a robot must not touch.
struct Surroundings {
  double width = 0;           ///< [m] of the arena
  double height = 0;          ///< [m]
  std::vector<Place> others;  ///< robots
  double diameter = 0;        ///< [m] of every robot
};

/// The distance that must be left everywhere on a pattern driven with nominal motors [m].
inline constexpr double kClearance = 0.02;

/// A heading, near to the present one, from which `pattern` leaves at least kClearance to walls and
/// robots: the present one if that is such, nothing when there is none.
[[nodiscard]] std::optional<double> clearHeading(const Pattern& pattern, const Place& robot,
                                                 const Surroundings& surroundings);

/// A straight way to a place where `pattern` has room.
struct EscapePath {
  double heading = 0;   ///< [rad]
  double distance = 0;  ///< [m]
};

/// The shortest way, up to 20 cm, away from the walls and robots that are too near; nothing when
/// there is none.
[[nodiscard]] std::optional<EscapePath> escapePath(const Pattern& pattern, const Place& robot,
                                                   const Surroundings& surroundings);

/// How far the robot goes from its start in `pattern` [m].
[[nodiscard]] double reachOf(const Pattern& pattern, double wheel_base);

}  // namespace lab::calibration
