/// The gaps of a measured recording, for simulated recordings with equal gaps: the covariance of
/// lags depends on the windows that exist.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/simulated_recording.hpp"

namespace lab::analysis {

/// Histogram of the lengths of the segments of a recording. No window crosses segments.
class SegmentLengths {
 public:
  void add(double frames);
  SegmentLengths& operator+=(const SegmentLengths& other);

  [[nodiscard]] double number() const;

  /// Number of windows of a lag [frames], relative to that in one long segment; 1 without segments.
  [[nodiscard]] double covered(double lag) const;

  /// A random length of a segment, frames. Needs at least one segment.
  [[nodiscard]] double draw(Random& random) const;

  /// A random length of the segment at a random time: weighted by length.
  [[nodiscard]] double drawAround(Random& random) const;

 private:
  static constexpr std::size_t kBins = 96;  ///< Four per octave.
  [[nodiscard]] static double lengthOf(std::size_t bin);

  template <typename Weight>
  [[nodiscard]] double drawBy(Random& random, const Weight& weight) const;

  std::array<std::uint32_t, kBins> counts_{};
};

/// Lags with a smaller share of windows are not used: the few segments that are so long are not
/// representative and do not determine the errors.
inline constexpr double kLeastCovered = 0.05;

struct RecordingGaps {
  double lost = 0;         ///< Share of frames that are missing.
  double lost_length = 1;  ///< Mean number of frames in a gap, geometrically distributed.
  double unseen = 0;       ///< Share of time in gaps that are too long to count as observed.
  bool cut = false;        ///< There are more segments than robots.
  SegmentLengths segments;

  /// Share of the windows of a lag [frames] that remain despite the cuts.
  [[nodiscard]] double covered(double lag) const { return cut ? segments.covered(lag) : 1; }
};

/// The gaps of a simulated recording: for each frame the number of its stretch, which windows do
/// not leave; -1: the frame is missing.
struct RecordingStretches {
  std::vector<int> of_places;
  std::vector<int>
      of_headings;  ///< Also cut at longer gaps, across which the heading is ambiguous.
};

/// @param frame_period of the measured recording, s
/// @param period frame period of the simulated one, s; it has `frames` frames
[[nodiscard]] RecordingStretches drawStretches(const RecordingGaps& gaps, double frame_period,
                                               double period, std::size_t frames,
                                               std::uint64_t seed);

}  // namespace lab::analysis
