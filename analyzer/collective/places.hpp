/// Where robots are: regions of the arena and bands of the light, and how they change between them.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "analyzer/collective/observation.hpp"

namespace lab::collective {

/// A named part of the arena.
struct Region {
  std::string name;
  bool circle = false;
  double x = 0;       ///< [m] centre
  double y = 0;       ///< [m]
  double radius = 0;  ///< [m] of a circle
  double width = 0;   ///< [m] of a rectangle, along x
  double height = 0;  ///< [m]

  [[nodiscard]] bool contains(double px, double py) const;
};

/// The place of each robot over time. A robot has changed its place when it was found in the new
/// one for `confirm` [s] without interruption, so that the tracker's noise at a border does not
/// count as a flux. The change counts at its confirmation.
class PlaceTracker {
 public:
  explicit PlaceTracker(double confirm) : confirm_(confirm) {}

  struct Change {
    int from = -1;  ///< -1: unknown before
    int to = -1;    ///< equal to `from`: no change
  };

  /// @param place in which the robot is found, from 0; -1: unknown, the last one stays
  /// @return its confirmed place before and now
  Change take(double time, int robot, int place);

  void forget(int robot) { robots_.erase(robot); }

 private:
  struct State {
    int place = -1;
    int candidate = -1;
    double since = 0;  ///< [s] of the candidate
  };

  double confirm_;
  std::map<int, State> robots_;
};

}  // namespace lab::collective
