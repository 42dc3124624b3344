/// The motion of the robots as it was filmed, to be shown beside the free motion when much of the
/// time is not free.
#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

/// The shares of the frames of a program by what the robots did in them; together 1.
struct TimeShares {
  double free = 1;
  double reversing = 0;
  double contact = 0;
  double stopped = 0;
  double lost = 0;

  /// What is removed from the motion although it is known.
  [[nodiscard]] double cut() const { return reversing + contact + stopped; }
};

/// The shares of a program without frames: all is free.
[[nodiscard]] TimeShares sharesOf(const ProgramTally& tally);

/// A larger share of cut time is named before the verdict, which is about free motion only.
inline constexpr double kMuchCut = 0.1;

/// One lag of the whole motion, SI units.
struct WholeLag {
  double tau = 0;
  double msd = 0;
  double angular_msd = 0;  ///< nan: no headings.
  double windows = 0;
};

/// The whole motion of one robot or many.
struct WholeMotion {
  /// Mean speed along the heading, m/s: that of a reversal counts as positive, motion across the
  /// heading does not count. nan: no headings.
  double speed = units::kNan;
  double observed = 0;         ///< s.
  std::vector<WholeLag> lags;  ///< Those with windows, ascending. Tracker noise is not removed.
};

/// The sums of whole motion.
struct WholeSums {
  BlockData blocks;
  double forward = 0;  ///< m.
  double time = 0;     ///< Of these steps, s.

  void pool(const WholeSums& other);
  [[nodiscard]] WholeMotion motion() const;
};

/// Accumulates the whole motion of one robot and program: all frames in which the robot ran it,
/// with contacts, reversals and stops. No window crosses the start of the program.
class WholeAccumulator {
 public:
  /// @param lags,frame_period as of MsdAccumulator
  WholeAccumulator(std::vector<int> lags, double frame_period)
      : accumulator_(std::move(lags), frame_period) {}

  /// Takes the frames in time order; lost ones are ignored.
  void add(const FrameReport& frame);

  [[nodiscard]] WholeSums sums() const { return {accumulator_.data(), forward_, time_}; }

 private:
  void addStep(const Sample& to, FrameState state);

  MsdAccumulator accumulator_;
  Sample last_;
  FrameState last_state_ = FrameState::kLost;  ///< kLost: there is no last sample.
  std::int64_t epoch_ = 0;
  double forward_ = 0;
  double time_ = 0;
};

}  // namespace lab::analysis
