/// MSD and angular MSD of the motion as it was filmed, with contacts, reversals and stops.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <vector>

#include "analyzer/collective/observable.hpp"
#include "analyzer/collective/observation.hpp"

namespace lab::collective {

/// Mean square displacements over windows between frames that are evaluated. Unlike the curves of
/// free motion, nothing is cut and nothing is joined. A window counts if the robot was seen in both
/// frames and belonged to the group (ran the program) all the time between.
class WholeMotion {
 public:
  explicit WholeMotion(const CrowdSettings& settings);

  /// Takes an evaluated frame.
  /// @param robots headings must be continuous, not wrapped
  void add(double time, const std::vector<CrowdRobot>& robots);

  /// Ends the track of a robot, as a frame without it does, and frees its memory.
  void forget(int robot) { tracks_.erase(robot); }

  [[nodiscard]] ObservableCurve msd() const;
  [[nodiscard]] ObservableCurve angularMsd() const;

 private:
  struct Pose {
    double time;
    float x;
    float y;
    double theta;
  };
  struct Track {
    std::deque<Pose> poses;  ///< successive evaluated frames
  };
  // Channels: for each lag squared displacement, windows, squared rotation, windows with headings.
  static constexpr std::size_t kPerLag = 4;
  static constexpr std::size_t kBlocks = 64;

  double period_;
  std::vector<std::size_t> lags_;  ///< in evaluated frames
  BlockedSums sums_;
  std::map<int, Track> tracks_;
};

}  // namespace lab::collective
