#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// Properties of the reversals to be found. SI units.
struct ReversalSearch {
  bool wanted = true;  ///< False: headings are corrected, and reversals are not searched for.
  double speed = units::kNan;  ///< m/s; nan: estimated from the track.
  double max_distance = 0.4;   ///< m
  double least_time = 0.4;     ///< Shorter ones cannot be distinguished from free motion, s.
  double sense_distance = 0;   ///< See senseDistance(); 0: the motion does not show the head.
  bool one_way = false;        ///< The program never drives backward.
  double free_speed = 0;       ///< Mean speed toward a wall before a reversal, m/s.
  double edge_time =
      0.15;  ///< Time before and after a reversal over which free motion is taken as uniform, s.
  double hold = 0;             ///< epsilon of a program that draws its speed, s; 0: constant speed.
  double drawn_mean = 0;       ///< m/s
  double drawn_width = 0;      ///< Half width of the draws of each wheel, m/s.
  double max_turn_rate = 7.2;  ///< Of the headings, rad/s.
  bool headings = true;        ///< False: theta is not used.
};

/// The search settings for a program. `speed` (m/s) and `distance` (m) are those of the experiment;
/// speed nan: estimated from the track.
[[nodiscard]] ReversalSearch reversalSearch(const ProgramLaw& law, double speed, double distance);

/// A stretch of straight, uniform motion that the program cannot produce.
struct FoundReversal {
  double start = 0;    ///< s
  double end = 0;      ///< s
  double dx = 0;       ///< Displacement, m.
  double dy = 0;       ///< m
  double heading = 0;  ///< Mean corrected heading, rad.
};

/// Results for one track.
struct TrackFindings {
  std::vector<FoundReversal> reversals;  ///< In time order.
  double speed = 0;        ///< Speed of reversing, given or estimated, m/s; nan: none found.
  double sigma = 0;        ///< Tracker noise per axis, m, from the motion across the headings.
  std::int64_t flips = 0;  ///< Headings flipped.
  std::int64_t flip_jumps = 0;
  std::int64_t sense_turns = 0;  ///< Chains of headings that were flipped as a whole.
};

/// The standard error of the headings of a track, rad, from the median of their second differences.
/// Uniform turns cancel in these, and the median ignores changes of the turning rate and flips.
/// @param track as for examineTrack()
[[nodiscard]] double headingNoise(const std::vector<TrackPoint>& track);

/// Corrects the headings of a track in place, and finds its reversals, for robots without
/// telemetry. `track` holds the valid points of one robot in strictly ascending time.
///
/// A robot that backs away from a wall drives straight and uniformly for seconds and keeps its
/// heading, while its program turns it every epsilon. For programs that drive forward, backward
/// motion identifies reversals. The others do not draw the same speed for long enough.
/// 1. Headings are made continuous (FlipFilter).
/// 2. A line of constant velocity is fitted in windows of least_time. Windows that fit within the
/// noise, have the speed, and have a constant heading along the line are joined to stretches.
/// 3. For each chain of headings, the displacement outside of these stretches decides which end is
/// the head. For programs that never drive backward, only backward stretches are kept.
/// 4. The ends of a reversal are where the line meets the adjacent free motion, at free_speed.
[[nodiscard]] TrackFindings examineTrack(std::vector<TrackPoint>& track,
                                         const ReversalSearch& search);

/// Reports the found reversals as telemetry of the robot would.
class ReversalReporter {
 public:
  explicit ReversalReporter(std::vector<FoundReversal> reversals)
      : reversals_(std::move(reversals)) {}

  /// Sets the fields of the telemetry that describe reversals, for telemetry.time. Times must not
  /// decrease.
  void report(RobotTelemetry& telemetry);

  /// Total time in reversals up to the time of the last telemetry, s.
  [[nodiscard]] double removed() const { return removed_; }

 private:
  std::vector<FoundReversal> reversals_;
  std::size_t begun_ = 0;
  double before_ = 0;  ///< s, of the reversals before the last one that began.
  double removed_ = 0;
};

}  // namespace lab::analysis
