#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analyzer/track_stitcher.hpp"

namespace lab::analysis {

/// The windows of one lag: powers of the displacement r and of the rotation a.
struct LagSums {
  std::uint32_t windows = 0;
  std::uint32_t angular_windows = 0;
  double r2 = 0;  ///< Sum of r^2, m^2.
  double r4 = 0;  ///< m^4.
  double a2 = 0;  ///< rad^2.
  double a4 = 0;  ///< rad^4.
};

/// Everything that one block of free time adds to the sums. The statistics of a film are the sums
/// over its blocks; their scatter gives the error bars.
struct BlockSums {
  double time = 0;            ///< Observed free time, s.
  std::vector<LagSums> lags;  ///< One a lag of the grid.
  double forward = 0;         ///< Displacement along the heading between consecutive frames, m.
  double forward_time = 0;    ///< The time of these steps, s.
  double sideways2 = 0;  ///< Sum of squares of one-frame displacements across the heading, m^2.
  double steps = 0;      ///< Their number.
  double joins = 0;      ///< Removed reversals.
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

  /// Adds the robots of another data set; their blocks stay independent blocks.
  void pool(const BlockData& other);

  [[nodiscard]] BlockSums total() const;
  [[nodiscard]] double observed() const;  ///< Free time, s.

  /// The mean duration of the windows of lag i; frames times frame_period where there is none.
  [[nodiscard]] double lagTime(std::size_t i, const BlockSums& total) const;
};

/// MSD and angular MSD of one robot and program, online, in memory bounded by the longest lag.
///
/// Overlapping windows; positions are never averaged. A window needs its two end frames and lies in
/// one segment. Within a piece it joins frames that are exactly a lag apart; across a removed
/// reversal, where frames no longer align, its start is interpolated linearly at exactly t - lag.
/// From 16 frames on only every (lag/16 to lag/8)-th end frame is used, chosen by the golden
/// ratio so that no program's clock can lock to the choice; that raises errors by less than 1 %.
///
/// Blocks: at most 64, of nearly equal free time; when full, pairs merge to 32.
class MsdAccumulator {
 public:
  /// Lags in frames, ascending and positive; the nominal frame period in s.
  MsdAccumulator(std::vector<int> lags, double frame_period);

  /// Takes the samples of one robot in time order. Samples of other programs must not come here;
  /// a program that comes back does so with a new segment.
  void add(const Sample& sample);

  [[nodiscard]] const BlockData& data() const { return data_; }

 private:
  /// A stored sample. Slots count frame periods; a lost frame leaves its slot stale.
  struct Fix {
    std::int64_t slot = -1;
    double time = 0;
    double x = 0;
    double y = 0;
    double theta = 0;
  };

  [[nodiscard]] const Fix* find(std::int64_t slot) const;
  [[nodiscard]] std::optional<Fix> interpolated(double time, std::int64_t guess) const;
  void beginSegment();
  void addStep(const Fix& from, const Fix& to, double frames, bool join);
  void addTime(double dt);
  void addWindows(const Fix& end);
  void addJoinWindow(std::size_t i, const Fix& end);

  BlockData data_;
  std::vector<Fix> ring_;
  std::size_t mask_ = 0;
  std::vector<std::size_t> active_;  ///< By level: how many lags a frame of this level may end.
  double block_length_ = 0;

  Sample last_;
  std::int64_t slot_ = 0;
  std::int64_t segment_first_ = 0;
  std::int64_t piece_first_ = 0;
  std::int64_t angular_first_ = 0;
  std::size_t in_segment_ = 0;  ///< Lags that reach back no farther than the segment's begin.
  std::size_t in_piece_ = 0;
  std::size_t in_angular_ = 0;
  bool empty_ = true;
  double period_time_ = 0;    ///< The frame period as measured: time per
  double period_frames_ = 0;  ///< this many frames.
  double period_ = 0;
};

}  // namespace lab::analysis
