#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/recording_gaps.hpp"

namespace lab::analysis {

/// Sums over the windows of one lag: powers of the displacement r and of the rotation a.
struct LagSums {
  std::uint32_t windows = 0;
  std::uint32_t angular_windows = 0;
  double r2 = 0;  ///< Sum of r^2, m^2.
  double a2 = 0;  ///< rad^2.
  double r4 = 0;  ///< m^4.
  double a4 = 0;  ///< rad^4.

  LagSums& operator+=(const LagSums& other);
  LagSums& operator-=(const LagSums& other);
};

/// The sums over one block of free time: the time in which the robot moved freely and was tracked,
/// without reversals, contacts and stops. The statistics of a recording are the sums over its
/// blocks; the scatter between blocks gives the error bars.
struct BlockSums {
  double time = 0;            ///< Observed free time, s.
  std::vector<LagSums> lags;  ///< One per lag of the grid.
  double forward = 0;         ///< Displacement along the heading between consecutive frames, m.
  double forward_time = 0;    ///< Time of these steps, s.
  double sideways2 = 0;  ///< Sum of squares of one-frame displacements across the heading, m^2.
  double steps = 0;      ///< Number of these displacements.
  double joins = 0;      ///< Number of removed reversals.
  double lost = 0;       ///< Frames missing in gaps of up to 2 s.
  double lost2 = 0;      ///< Sum over the gaps of the squared numbers of missing frames.
  double unseen = 0;     ///< Part of these gaps that is not in the observed time, s.
  double segments = 0;   ///< Segments that began in it. No window crosses segments.
  double run_time = 0;   ///< Time in runs, s.
  double run_span = 0;   ///< Time in which run time was counted, s.
  double tumbles = 0;    ///< Tumbles that began in it.

  BlockSums& operator+=(const BlockSums& other);
  BlockSums& operator-=(const BlockSums& other);
};

/// The blocks of one or many robots that run the same program on the same lag grid.
struct BlockData {
  std::vector<int> lags;          ///< Frames.
  double frame_period = 0;        ///< s.
  std::vector<double> lag_times;  ///< Sum of the true durations of the windows, per lag, s.
  std::vector<std::vector<BlockSums>> tracks;  ///< The blocks of each robot, in time order.
  SegmentLengths segments;

  /// Adds the robots of another data set. Their blocks remain separate.
  void pool(const BlockData& other);

  [[nodiscard]] BlockSums total() const;
  [[nodiscard]] double observed() const;  ///< Free time, s.

  /// The mean duration of the windows of lag i, s; the nominal duration if there are none.
  [[nodiscard]] double lagTime(std::size_t i, const BlockSums& total) const;
};

/// The share of the windows of a lag [frames] that remain despite the cuts. Headings are also cut at
/// gaps across which they are ambiguous, so angular windows are counted by themselves.
/// @param sums of this lag
[[nodiscard]] double coveredShare(const RecordingGaps& gaps, double lag, const LagSums& sums,
                                  bool angular);

/// The gaps of these recordings.
/// @param total data.total()
[[nodiscard]] RecordingGaps gapsOf(const BlockData& data, const BlockSums& total);

}  // namespace lab::analysis
