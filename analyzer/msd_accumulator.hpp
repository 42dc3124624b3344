#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "analyzer/block_store.hpp"
#include "analyzer/block_sums.hpp"
#include "analyzer/track_stitcher.hpp"

namespace lab::analysis {

/// MSD and angular MSD of one robot and program, online, in less than 50 kB however long the film
/// and its lags are: a multi-tau scheme that leaves frames out and never averages them.
///
/// Overlapping windows; a window needs its two end frames and lies in one segment. Within a piece
/// it joins frames that are exactly a lag apart. From 16 frames on only every (lag/16 to lag/8)-th
/// window counts, chosen by the golden ratio so that no program's clock can lock to the choice;
/// that raises errors by less than 1 %. Up to 64 frames the choice is of end frames. Above that it
/// is of the frames with which windows begin, and of old frames only these are kept; as any frame
/// may end a window, a lag need not be a multiple of anything.
///
/// Across a removed reversal frames no longer align: one end of the window is interpolated linearly
/// between two frames so that it lasts exactly the lag, the end that the choice is not of.
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
  /// A stored sample. Slots count frame periods; a lost frame leaves its slot stale.
  struct Fix {
    std::int64_t slot = -1;
    double time = 0;
    double x = 0;
    double y = 0;
    double theta = 0;
  };

  static constexpr int kDenseLags = 64;            ///< Below, every frame is at hand.
  static constexpr std::size_t kDenseFixes = 80;   ///< For these, and for what joins shift.
  static constexpr std::size_t kSteps = 3;         ///< From every window to every fourth one.
  static constexpr std::size_t kFixes = 18;        ///< A level's: 16 strides, and some for joins.
  static constexpr std::size_t kWheel = 256;      ///< Slots, a power of two.

  /// One octave of lags, and the frames at which their windows begin.
  struct Level {
    std::uint64_t stride = 0;  ///< Frames between these on average, in units of 2^-24.
    std::uint64_t next = 0;    ///< The next slot to be kept, in the same units.
    std::uint16_t head = 0;    ///< Where it goes.
    std::array<Fix, kFixes> fixes;
  };
  /// The newest frames, newest first from `newest`, twice over so that no row of them wraps.
  struct Recent {
    static constexpr std::size_t kLength = NearSums::kLags + 1;

    void push(const Fix& fix);

    std::array<double, 2 * kLength> time{};
    std::array<double, 2 * kLength> x{};
    std::array<double, 2 * kLength> y{};
    std::array<double, 2 * kLength> theta{};
    std::size_t newest = 0;
    std::size_t unbroken = 0;  ///< So many frames of one piece without a gap, the newest included.
  };
  /// Of a lag above the dense ones.
  struct Cursor {
    int lag = 0;
    std::uint16_t level = 0;
    std::uint16_t start = 0;  ///< Where in its level its next window begins; head: not yet.
  };

  [[nodiscard]] const Fix* find(std::int64_t slot) const;
  [[nodiscard]] std::optional<Fix> interpolated(double time, std::int64_t guess) const;
  void beginSegment();
  void addStep(const Fix& from, const Fix& to, double frames, bool join);
  void addWindow(std::size_t i, const Fix& start, const Fix& end, double duration, bool angular);
  /// @return whether all near lags had a window that ended here; then they were added
  bool addNearWindows(const Fix& end);
  void addDenseWindows(const Fix& end);
  void addJoinWindow(std::size_t i, const Fix& end);

  void turnWheel(std::int64_t from, const Fix& end);
  void schedule(std::size_t task, std::int64_t due);
  void scheduleAll();
  [[nodiscard]] std::int64_t keep(Level& level, const Fix& fix) const;
  [[nodiscard]] std::int64_t endWindows(std::size_t c, const Fix& end);
  void addEndedAcrossJoin(std::size_t i, const Fix& start, const Fix& end);

  std::vector<int> lags_;
  double frame_period_;
  std::vector<double> lag_times_;
  BlockStore blocks_;

  Recent recent_;
  std::array<Fix, kDenseFixes> dense_;
  std::size_t near_lags_ = 0;   ///< Lags of at most NearSums::kLags frames.
  std::size_t dense_lags_ = 0;  ///< Lags below kDenseLags.
  std::array<std::size_t, kSteps> active_{};  ///< By step: how many of them a frame may end.
  std::vector<Level> levels_;
  std::vector<Cursor> cursors_;  ///< By lag, from dense_lags_ on.
  /// What is to be done at which slot, by slot modulo the wheel. A task is a cursor's window that
  /// ends, or behind all cursors a level's frame to keep; 0: none. What lies more than a turn ahead
  /// is put in again on the way.
  std::array<std::uint16_t, kWheel> wheel_{};  ///< The first task, from 1,
  std::vector<std::uint16_t> following_;       ///< and by task the next one in the same slot.

  Sample last_;
  Fix previous_;  ///< The frame before this one, if it lies in the same segment.
  std::int64_t slot_ = 0;
  std::int64_t segment_first_ = 0;
  std::int64_t piece_first_ = 0;
  std::int64_t angular_first_ = 0;
  std::size_t in_segment_ = 0;  ///< Dense lags that reach back no farther than its begin.
  std::size_t in_piece_ = 0;
  std::size_t in_angular_ = 0;
  bool empty_ = true;
  double period_time_ = 0;    ///< The frame period as measured: time per
  double period_frames_ = 0;  ///< this many frames.
  double period_ = 0;
};

}  // namespace lab::analysis
