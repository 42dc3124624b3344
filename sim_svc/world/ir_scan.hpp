/// The six infrared sensors of a simulated robot.
#pragma once

#include <array>
#include <cstdint>

#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// A value from 0 to 65535, rounded to nearest as by std::lround, which is slower.
[[nodiscard]] inline std::uint16_t roundedCounts(double value) {
  const auto below = static_cast<std::uint16_t>(value);
  return static_cast<std::uint16_t>(below + (value - below >= 0.5 ? 1 : 0));
}

/// One scan: along each of the six directions (counter-clockwise from the heading, in steps of 60
/// degrees) the distance from the rim to the nearest wall or robot, at most the range.
class IrScan {
 public:
  static constexpr std::size_t kDirections = 6;

  /// @param centre,heading of the robot; heading is a unit vector
  /// @param radius of the robot and of every other robot [m]
  /// @param range of the sensors from the rim [m]
  IrScan(Vec centre, Vec heading, double radius, double range);

  /// Adds the walls of the arena.
  void addWalls(const Arena& arena);

  /// Adds another robot; `to_other` is the vector from the scanning robot's centre to its centre.
  void addDisk(Vec to_other);

  /// Whether anything is in range of any sensor.
  [[nodiscard]] bool anyInRange() const { return in_range_; }

  /// Readings [counts]: 1023 at the rim, falling linearly to 0 at the range, rounded to nearest.
  [[nodiscard]] std::array<std::uint16_t, kDirections> counts() const;

 private:
  void addDistance(std::size_t direction, double distance) {
    if (distance < distance_[direction]) {
      distance_[direction] = distance;
      in_range_ = true;
    }
  }

  Vec centre_;
  double radius_;
  double range_;
  std::array<Vec, kDirections / 2> axes_;  ///< Directions 0 to 2; 3 to 5 are their opposites.
  std::array<double, kDirections> distance_;
  bool in_range_ = false;
};

}  // namespace lab::sim
