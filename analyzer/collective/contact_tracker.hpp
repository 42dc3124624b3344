/// Contacts between robots, and of robots with walls, over time.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "analyzer/collective/observation.hpp"

namespace lab::collective {

/// A contact of two robots that has ended.
struct EndedContact {
  std::size_t first = 0;  ///< index of a robot in the frame
  std::size_t second = 0;
  double duration = 0;  ///< [s] nan: it had begun before the first frame of both robots
};

/// What a frame changed.
struct ContactFrame {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< in contact now, by index
  std::vector<char> touching;                              ///< of each robot: touches another one
  std::vector<char> at_wall;                               ///< of each robot
  std::vector<EndedContact> ended;
  std::vector<std::size_t> left_wall;  ///< robots whose stay at a wall has ended
};

/// Two robots are in contact from a distance of their centres of 1.03 diameters on, until it
/// exceeds 1.06 diameters, so that the tracker's noise does not end contacts. A robot is at a wall
/// with the same margins. A contact of which a robot is not seen for half a second is forgotten,
/// and its end does not count.
class ContactTracker {
 public:
  explicit ContactTracker(const CrowdSettings& settings) : settings_(settings) {}

  /// Takes every camera frame, in the order of time [s].
  /// @return valid until the next call
  const ContactFrame& take(double time, const std::vector<CrowdRobot>& robots);

  /// Forgets a robot that has not been seen for long.
  void forget(int robot);

 private:
  struct Contact {
    double begin;  ///< [s] nan: before the first frame
    double seen;   ///< [s] last frame with both robots
  };

  void walls(double time, const std::vector<CrowdRobot>& robots);

  CrowdSettings settings_;
  ContactFrame frame_;
  std::map<std::pair<int, int>, Contact> contacts_;  ///< by ids, the lower one first
  std::map<int, double> at_wall_;                    ///< by id: last frame [s]
  std::map<int, double> first_seen_;                 ///< by id [s]
  std::map<int, std::size_t> index_;
  double last_time_ = 0;  ///< [s]
  std::vector<Point> points_;
  std::vector<std::size_t> order_;
};

}  // namespace lab::collective
