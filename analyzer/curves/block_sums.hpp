#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/recording_gaps.hpp"

namespace lab::analysis {

/// The windows of one lag: powers of the displacement r and of the rotation a.
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

/// Everything that one block of free time adds to the sums. The statistics of a recording are the
/// sums over its blocks; their scatter gives the error bars.
struct BlockSums {
  double time = 0;            ///< Observed free time, s.
  std::vector<LagSums> lags;  ///< One a lag of the grid.
  double forward = 0;         ///< Displacement along the heading between consecutive frames, m.
  double forward_time = 0;    ///< The time of these steps, s.
  double sideways2 = 0;  ///< Sum of squares of one-frame displacements across the heading, m^2.
  double steps = 0;      ///< Their number.
  double joins = 0;      ///< Removed reversals.
  double lost = 0;       ///< Frames missing in gaps of up to 2 s.
  double lost2 = 0;      ///< Sum of the squares of their numbers, gap by gap.
  double unseen = 0;     ///< Of these gaps, what is not in the observed time, s.
  double segments = 0;   ///< Begun in it: no window lies in two of them.
  double run_time = 0;   ///< In runs (RTP), s.
  double run_span = 0;   ///< The time in which runs were counted, s.
  double tumbles = 0;    ///< Begun in it (RTP).

  BlockSums& operator+=(const BlockSums& other);
  BlockSums& operator-=(const BlockSums& other);
};

/// The blocks of one or many robots that run the same program on the same lag grid.
struct BlockData {
  std::vector<int> lags;          ///< Frames.
  double frame_period = 0;        ///< s.
  std::vector<double> lag_times;  ///< Sum of the windows' true durations, one a lag, s.
  std::vector<std::vector<BlockSums>> tracks;  ///< Per robot, in time order.
  SegmentLengths segments;

  /// Adds the robots of another data set; their blocks stay independent blocks.
  void pool(const BlockData& other);

  [[nodiscard]] BlockSums total() const;
  [[nodiscard]] double observed() const;  ///< Free time, s.

  /// The mean duration of the windows of lag i; frames times frame_period where there is none.
  [[nodiscard]] double lagTime(std::size_t i, const BlockSums& total) const;
};

/// What these recordings lack.
/// @param total data.total()
[[nodiscard]] RecordingGaps gapsOf(const BlockData& data, const BlockSums& total);

}  // namespace lab::analysis
