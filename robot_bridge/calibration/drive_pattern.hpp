/// The motion patterns for the calibration of motors, and the search for free space.
#pragma once

#include <optional>
#include <vector>

#include "robot_bridge/calibration/motors.hpp"

namespace lab::calibration {

/// Constant wheel speeds for a time.
struct PatternStep {
  double left = 0;      ///< [m/s]
  double right = 0;     ///< [m/s]
  double duration = 0;  ///< [s] without kSettleTime
};

using Pattern = std::vector<PatternStep>;

/// Longest delay until a change of the wheel speeds takes effect [s]. Poses in this time after an
/// order are not used.
inline constexpr double kSettleTime = 0.15;

/// Drives both wheels together, both in opposite directions, and each wheel alone, forth and back,
/// at about 15, 30, 50 and 70 % of full duty: 32 steps, about 40 s, within 14 cm of the start.
/// @param stored calibration in the robot; the speeds are chosen such that it gives whole duties
/// @param max nominal speed at full duty [m/s]
[[nodiscard]] Pattern calibrationPattern(const Motors& stored, double max);

/// Other speeds than the calibration, and arcs, forth and back: 12 steps.
[[nodiscard]] Pattern checkPattern(double max);

/// The pose of a robot.
struct Place {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
};

/// The obstacles around a robot.
struct Surroundings {
  double width = 0;           ///< [m] of the arena
  double height = 0;          ///< [m]
  std::vector<Place> others;  ///< other robots
  double diameter = 0;        ///< [m] of every robot
};

/// Smallest distance to obstacles during a pattern, computed for nominal motors [m].
inline constexpr double kClearance = 0.02;

/// The heading nearest to the present one from which `pattern` keeps at least kClearance to walls
/// and robots; empty if there is none.
[[nodiscard]] std::optional<double> clearHeading(const Pattern& pattern, const Place& robot,
                                                 const Surroundings& surroundings);

/// A straight path to a position where `pattern` has room.
struct EscapePath {
  double heading = 0;   ///< [rad]
  double distance = 0;  ///< [m]
};

/// The shortest such path, up to 20 cm, away from walls and robots that are too near; empty if
/// there is none.
[[nodiscard]] std::optional<EscapePath> escapePath(const Pattern& pattern, const Place& robot,
                                                   const Surroundings& surroundings);

/// Largest distance of the robot from its start during `pattern` [m].
[[nodiscard]] double reachOf(const Pattern& pattern, double wheel_base);

}  // namespace lab::calibration
