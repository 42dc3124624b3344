#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "analyzer/bootstrap/recording_gaps.hpp"
#include "analyzer/curves/hold_period.hpp"

namespace lab::analysis {

/// Sums over the windows of one lag: powers of the displacement r and of the rotation a.
struct LagSums {
  std::uint32_t windows = 0;
  std::uint32_t angular_windows = 0;
  double r2 = 0;  ///< Sum of r^2, m^2.
  double a2 = 0;  ///< rad^2.
  double r4 = 0;  ///< m^4.
  double a4 = 0;  ///< rad^4.

  LagSums& operator+=(const LagSums& other) {
    windows += other.windows;
    angular_windows += other.angular_windows;
    r2 += other.r2;
    a2 += other.a2;
    r4 += other.r4;
    a4 += other.a4;
    return *this;
  }
  LagSums& operator-=(const LagSums& other) {
    windows -= other.windows;
    angular_windows -= other.angular_windows;
    r2 -= other.r2;
    a2 -= other.a2;
    r4 -= other.r4;
    a4 -= other.a4;
    return *this;
  }
};

/// The sums over one block of free time, except for those by lag.
struct BlockCounts {
  double time = 0;          ///< Observed free time, s.
  double forward = 0;       ///< Displacement along the heading between consecutive frames, m.
  double forward_time = 0;  ///< Time of these steps, s.
  double sideways2 = 0;     ///< Sum of squares of one-frame displacements across the heading, m^2.
  double steps = 0;         ///< Number of these displacements.
  double long_steps = 0;    ///< Number of displacements across lost frames.
  double long_frames2 = 0;  ///< Sum of their squared lengths, frames^2.
  double breaks = 0;        ///< Number of gaps across which no displacement is taken.
  double turn = 0;          ///< Rotation between consecutive frames, rad.
  double turn_time = 0;     ///< Time of these rotations, s.
  double joins = 0;         ///< Number of removed reversals.
  double lost = 0;          ///< Frames missing in gaps of up to 2 s.
  double lost2 = 0;         ///< Sum over the gaps of the squared numbers of missing frames.
  double unseen = 0;        ///< Part of these gaps that is not in the observed time, s.
  double segments = 0;      ///< Segments that began in it. No window crosses segments.
  double run_time = 0;      ///< Time in runs, s.
  double run_span = 0;      ///< Time in which run time was counted, s.
  double tumbles = 0;       ///< Tumbles that began in it.

  BlockCounts& operator+=(const BlockCounts& other);
  BlockCounts& operator-=(const BlockCounts& other);
};

/// The sums over one block of free time: the time in which the robot moved freely and was tracked,
/// without reversals, contacts and stops. The statistics of a recording are the sums over its
/// blocks; the scatter between blocks gives the error bars.
struct BlockSums : BlockCounts {
  std::vector<LagSums> lags;  ///< One per lag of the grid.

  BlockSums& operator+=(const BlockSums& other);
};

/// Blocks that take no more windows, and their sum.
struct ClosedBlocks {
  std::vector<BlockSums> blocks;  ///< In time order.
  BlockSums total;
};

/// The blocks of one robot in time order: those that are closed, which copies share, and the open
/// one.
class BlockTrack {
 public:
  BlockTrack(std::shared_ptr<const ClosedBlocks> closed, BlockSums open)
      : closed_(std::move(closed)), open_(std::move(open)) {}
  /// At least one block; the last one is open.
  BlockTrack(std::initializer_list<BlockSums> blocks);

  class Iterator {
   public:
    Iterator(const BlockTrack& track, std::size_t at) : track_(&track), at_(at) {}
    const BlockSums& operator*() const { return (*track_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const BlockTrack* track_;
    std::size_t at_;
  };

  [[nodiscard]] std::size_t size() const { return closed_->blocks.size() + 1; }
  const BlockSums& operator[](std::size_t i) const {
    return i < closed_->blocks.size() ? closed_->blocks[i] : open_;
  }
  [[nodiscard]] const BlockSums& front() const { return (*this)[0]; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size()}; }
  [[nodiscard]] const BlockSums& closedTotal() const { return closed_->total; }
  [[nodiscard]] const BlockSums& open() const { return open_; }

 private:
  std::shared_ptr<const ClosedBlocks> closed_;
  BlockSums open_;
};

/// The blocks of one or many robots that run the same program on the same lag grid.
struct BlockData {
  std::vector<int> lags;           ///< Frames.
  double frame_period = 0;         ///< s.
  std::vector<double> lag_times;   ///< Sum of the true durations of the windows, per lag, s.
  std::vector<BlockTrack> tracks;  ///< Of each robot.
  SegmentLengths segments;
  HoldSpectra holds{};  ///< Of programs whose holds are all equally long (Law::steadyHold).

  /// Adds the robots of another data set. Their blocks remain separate.
  void pool(const BlockData& other);

  [[nodiscard]] BlockSums total() const;
  [[nodiscard]] double observed() const;  ///< Free time: total().time, s.

  /// The mean duration of the windows of lag i, s; the nominal duration if there are none.
  [[nodiscard]] double lagTime(std::size_t i, const BlockSums& total) const;
};

/// The share of the windows of a lag [frames] that remain despite the cuts. Headings are also cut
/// at gaps across which they are ambiguous, so angular windows are counted by themselves.
/// @param sums of this lag
[[nodiscard]] double coveredShare(const RecordingGaps& gaps, double lag, const LagSums& sums,
                                  bool angular);

/// The gaps of these recordings.
/// @param total data.total()
[[nodiscard]] RecordingGaps gapsOf(const BlockData& data, const BlockSums& total);

}  // namespace lab::analysis
