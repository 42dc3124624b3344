#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// What a reversal looks like. SI units.
struct ReversalSearch {
  bool wanted = true;          ///< False: headings are mended, and nothing is searched for.
  double speed = units::kNan;  ///< m/s; nan: taken from the track.
  double max_distance = 0.4;   ///< m
  double least_time = 0.4;     ///< Shorter ones are not told from free motion, s.
  double sense_distance = 0;   ///< See senseDistance(); 0: head and tail are alike.
  bool one_way = false;        ///< The program never drives backward: only reversals do.
  double free_speed = 0;       ///< Mean speed with which the robot meets a wall, m/s.
  double edge_time = 0.15;     ///< Free motion is taken for even so long before and after, s.
  double hold = 0;             ///< epsilon of a program that draws its speed, s; 0: it does not.
  double drawn_mean = 0;       ///< m/s
  double drawn_width = 0;      ///< Half width of each wheel's draws, m/s.
  double max_turn_rate = 7.2;  ///< Of the headings, rad/s.
  bool headings = true;        ///< False: theta means nothing.
};

/// The search for the program's robots. `speed` and `distance` as the experiment sets them (m/s, m;
/// nan: the speed is taken from the track).
[[nodiscard]] ReversalSearch reversalSearch(const ProgramLaw& law, double speed, double distance);

/// A stretch of straight, even motion that the program cannot drive.
struct FoundReversal {
  double start = 0;    ///< s
  double end = 0;      ///< s
  double dx = 0;       ///< Way of it, m.
  double dy = 0;       ///< m
  double heading = 0;  ///< Mean over it, mended, rad.
};

/// What a whole track says about itself.
struct TrackFindings {
  std::vector<FoundReversal> reversals;  ///< In time order.
  double speed = 0;        ///< Of reversing as searched for or estimated, m/s; nan: none found.
  double sigma = 0;        ///< Noise of the tracker per axis, m, as the motion across the
                           ///< headings tells it.
  std::int64_t flips = 0;  ///< Headings turned round.
  std::int64_t flip_jumps = 0;
  std::int64_t sense_turns = 0;  ///< Stretches whose head was the tail all along.
};

/// The standard error of a track's headings as their second differences scatter, rad. Of even turns
/// nothing is left in these, and their median heeds neither draws of another turn nor flips.
/// @param track as for examineTrack()
[[nodiscard]] double headingNoise(const std::vector<TrackPoint>& track);

/// Mends the headings of a track, in place, and finds the reversals in it: for people whose robots
/// told nothing. `track` holds one robot's valid points in strictly ascending time.
///
/// A robot that backs from a wall drives straight and evenly for seconds and keeps its heading; its
/// program turns it every epsilon. Programs that drive forward never drive backward for long, and
/// that decides for them; the others do not draw the same speed so often that it would last.
/// 1. Headings are made continuous (FlipFilter).
/// 2. In windows of least_time a line of constant velocity is fitted; windows that fit within noise
///    at the speed and whose heading stands still, along the line, make stretches.
/// 3. Which end is the head is decided for each stretch of headings as a whole by what is driven
///    outside of these; then of programs that never drive backward only backward
///    stretches are kept.
/// 4. Each end is where the line meets the free motion beside it, driven at free_speed.
[[nodiscard]] TrackFindings examineTrack(std::vector<TrackPoint>& track,
                                         const ReversalSearch& search);

/// The found reversals as the robot itself would tell them.
class ReversalReporter {
 public:
  explicit ReversalReporter(std::vector<FoundReversal> reversals)
      : reversals_(std::move(reversals)) {}

  /// Fills in what telemetry.time needs of the reversals. Times must not go back.
  void tell(RobotTelemetry& telemetry);

  /// How long the robot had reversed up to the time of the last telemetry, s.
  [[nodiscard]] double removed() const { return removed_; }

 private:
  std::vector<FoundReversal> reversals_;
  std::size_t begun_ = 0;
  double before_ = 0;  ///< s, of the reversals before the last one begun.
  double removed_ = 0;
};

}  // namespace lab::analysis
