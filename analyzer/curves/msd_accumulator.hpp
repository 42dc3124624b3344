#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/curves/block_store.hpp"
#include "analyzer/curves/block_sums.hpp"
#include "analyzer/curves/frame_history.hpp"
#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// MSD and angular MSD of one robot and program, online, in less than 50 kB however long the
/// recording and its lags are: a multi-tau scheme that leaves frames out and never averages them.
///
/// Overlapping windows; a window needs its two end frames and lies in one segment. Within a piece
/// it joins frames that are exactly a lag apart. From 16 frames on only some windows count
/// (window_choice.hpp), which raises errors by less than 1 %. Below 64 frames the choice is of end
/// frames, which are all at hand. Above that it is of the frames with which windows begin, and of
/// old frames only these are kept; as any frame may end a window, a lag need not be a multiple of
/// anything.
///
/// Across a removed reversal frames no longer align: one end of the window is interpolated linearly
/// between two frames so that it lasts exactly the lag, the end that the choice is not of.
///
/// Frames are collected and their windows added lag by lag, two windows side by side. Where a
/// collection ends depends on the samples alone: asking for data() changes nothing, not a bit.
class MsdAccumulator {
 public:
  /// Lags in frames, ascending and positive; the nominal frame period in s.
  MsdAccumulator(std::vector<int> lags, double frame_period);

  /// Takes the samples of one robot in time order. Samples of other programs must not come here;
  /// a program that comes back does so with a new segment.
  void add(const Sample& sample);

  /// What has been measured so far: one track.
  [[nodiscard]] BlockData data() const;

  /// Free time so far, s.
  [[nodiscard]] double observed() const { return blocks_.time(); }

  /// Of this object and all that it holds.
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  static constexpr std::size_t kSteps = 3;   ///< From every window to every fourth one.
  static constexpr std::size_t kFixes = 18;  ///< A level's: 16 strides, and some for joins.

  /// Where in the history windows end, in ascending order.
  struct Ends {
    std::array<std::uint32_t, FrameHistory::kCollection> at;
    std::size_t count = 0;
  };
  /// One octave of lags, and the frames at which their windows begin.
  struct Level {
    std::uint64_t stride = 0;  ///< Frames between these on average, in units of 2^-24.
    std::uint64_t next = 0;    ///< The next slot to be kept, in the same units.
    std::uint16_t head = 0;    ///< Where it goes.
    std::array<Fix, kFixes> fixes;
  };
  /// Of a lag above the dense ones.
  struct Cursor {
    std::int64_t due = 0;  ///< Its next window does not end before this slot.
    int lag = 0;
    std::uint16_t level = 0;
    std::uint16_t start = 0;  ///< Where in its level its next window begins; head: not yet.
  };

  void beginSegment(const Sample& sample);
  [[nodiscard]] double segmentFrames() const;
  /// Takes what is more than the next frame: frames lost, a join, a cut of the angle.
  /// @return false: the sample falls onto the last slot
  bool resume(const Sample& sample, double dt);
  void addStep(const Fix& to, double frames, bool join);

  /// Adds what has been collected.
  void flush();
  void addSteps();
  void addDenseWindows();
  void addWindows(std::size_t i, const Ends& ends);
  void addBrokenWindow(std::size_t i, std::size_t end);
  void endLongWindows(std::size_t c);
  void addEndedAcrossJoin(std::size_t i, const Fix& start);
  void beginLongWindows(Level& level) const;
  void addWindow(std::size_t i, const Fix& start, const Fix& end, double duration);

  std::vector<int> lags_;
  double frame_period_;
  std::vector<double> lag_times_;
  BlockStore blocks_;

  FrameHistory frames_;           ///< Collects frames of one piece and one angular segment.
  std::size_t unbroken_ = 0;      ///< So many frames before the collection are of them, too.
  bool first_step_done_ = false;  ///< The step to its first frame has been added.
  std::size_t dense_lags_ = 0;    ///< Lags below kDenseLags.
  std::vector<Level> levels_;
  std::vector<Cursor> cursors_;  ///< By lag, from dense_lags_ on.

  SegmentLengths segments_;  ///< That have ended.
  Sample last_;
  double segment_begin_ = 0;  ///< Free time, s.
  Sample counted_;            ///< Its runs and tumbles and those before are in the blocks.
  Fix previous_;              ///< The frame before the collection, if it lies in the same segment.
  std::int64_t segment_first_ = 0;
  std::int64_t piece_first_ = 0;
  std::int64_t angular_first_ = 0;
  bool empty_ = true;
  double period_time_ = 0;    ///< The frame period as measured: time per
  double period_frames_ = 0;  ///< this many frames.
  double period_ = 0;
};

}  // namespace lab::analysis
