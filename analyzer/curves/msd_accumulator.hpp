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

/// MSD and angular MSD of one robot and program, online, in less than 50 kB for any length of the
/// recording and its lags: a multi-tau scheme that skips frames and does not average them.
///
/// Windows overlap. A window needs its two end frames, and lies in one segment. Within a piece, its
/// end frames are exactly a lag apart. From 16 frames on only some windows are used
/// (window_choice.hpp), which increases errors by less than 1 %. Below 64 frames, end frames are
/// chosen, and all frames are in memory. Above, the first frames of windows are chosen, and only
/// these old frames are kept. Any frame may end a window, so lags are not restricted to multiples.
///
/// Across a removed reversal frames are not aligned. The end of the window that was not chosen is
/// interpolated linearly between two frames, so that the window lasts exactly the lag.
///
/// Frames are collected, and their windows added lag by lag, two windows in parallel. The end of a
/// collection depends on the samples alone, so calls of data() do not change results.
class MsdAccumulator {
 public:
  /// Lags in frames, ascending and positive; the nominal frame period in s.
  /// @param turns_on_the_spot turns lie between straight runs (Law::runs)
  MsdAccumulator(std::vector<int> lags, double frame_period, bool turns_on_the_spot = false);

  /// Takes the samples of one robot and program in time order. A program that runs again has a new
  /// segment.
  void add(const Sample& sample);

  /// The blocks so far, as one track.
  [[nodiscard]] BlockData data() const;

  /// Free time so far, s.
  [[nodiscard]] double observed() const { return blocks_.time(); }

  /// Size of this object and its heap memory.
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  /// The share by which a step across lost frames is shorter than the way of the robot, beyond what
  /// a step of one frame is.
  [[nodiscard]] double shortened(double turn, double frames) const;

  static constexpr std::size_t kSteps = 3;   ///< All windows, every second, every fourth.
  static constexpr std::size_t kFixes = 18;  ///< Per level: 16 strides, and some for joins.

  /// Positions in the history where windows end, ascending.
  struct Ends {
    std::array<std::uint32_t, FrameHistory::kCollection> at;
    std::size_t count = 0;
  };
  /// One octave of lags, and the frames with which their windows begin.
  struct Level {
    std::uint64_t stride = 0;  ///< Mean distance of these frames, in units of 2^-24 frames.
    std::uint64_t next = 0;    ///< The next slot to keep, in the same units.
    std::uint16_t head = 0;    ///< Index for it in fixes.
    std::array<Fix, kFixes> fixes;
  };
  /// State of a lag above the dense ones.
  struct Cursor {
    std::int64_t due = 0;  ///< Earliest slot at which the next window ends.
    int lag = 0;
    std::uint16_t level = 0;
    std::uint16_t start =
        0;  ///< Index in its level of the beginning of the next window; head: none yet.
  };

  void beginSegment(const Sample& sample);
  [[nodiscard]] double segmentFrames() const;
  /// Continues after lost frames, a join or a cut of the angle. @return false: the sample falls on
  /// the last slot
  bool resume(const Sample& sample, double dt);
  void addStep(const Fix& to, double frames, bool join);

  /// Adds the collected frames to the sums.
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
  bool turns_on_the_spot_ = false;
  double frame_period_;
  std::vector<double> lag_times_;
  BlockStore blocks_;

  FrameHistory frames_;           ///< The collection lies in one piece and one angular segment.
  std::size_t unbroken_ = 0;      ///< Number of frames before the collection in the same ones.
  bool first_step_done_ = false;  ///< The step to the first frame of the collection has been added.
  std::size_t dense_lags_ = 0;    ///< Number of lags below kDenseLags.
  std::vector<Level> levels_;
  std::vector<Cursor> cursors_;  ///< By lag, from dense_lags_ on.

  SegmentLengths segments_;  ///< Segments that have ended.
  Sample last_;
  double segment_begin_ = 0;  ///< Free time, s.
  Sample counted_;            ///< Last sample whose runs and tumbles are in the blocks.
  Fix previous_;              ///< The frame before the collection, if it is in the same segment.
  std::int64_t segment_first_ = 0;
  std::int64_t piece_first_ = 0;
  std::int64_t angular_first_ = 0;
  bool empty_ = true;
  double period_time_ = 0;    ///< The measured frame period is this time [s]
  double period_frames_ = 0;  ///< divided by this number of frames.
  double period_ = 0;
};

}  // namespace lab::analysis
