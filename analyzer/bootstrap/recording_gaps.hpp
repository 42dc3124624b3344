/// What a measured recording lacks, so that simulated ones can lack it too: curves err together by
/// which windows they are made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/simulated_recording.hpp"

namespace lab::analysis {

/// How long the segments of a recording are, which no window leaves: their numbers by length.
class SegmentLengths {
 public:
  void add(double frames);
  SegmentLengths& operator+=(const SegmentLengths& other);

  [[nodiscard]] double number() const;

  /// Share of the windows of a lag [frames] that there would be in one long segment; 1: no
  /// segments.
  [[nodiscard]] double covered(double lag) const;

  /// The length of a segment, frames; needs one at least.
  [[nodiscard]] double draw(Random& random) const;

  /// The same of the one that a moment lies in: longer ones more often.
  [[nodiscard]] double drawAround(Random& random) const;

 private:
  static constexpr std::size_t kBins = 96;  ///< Four an octave.
  [[nodiscard]] static double lengthOf(std::size_t bin);

  template <typename Weight>
  [[nodiscard]] double drawBy(Random& random, const Weight& weight) const;

  std::array<std::uint32_t, kBins> counts_{};
};

/// Lags of which cuts leave a smaller share of the windows are not used: the few segments that are
/// so long say little of how lags err, and are not like the others.
inline constexpr double kLeastCovered = 0.05;

struct RecordingGaps {
  double lost = 0;         ///< Share of the frames that are missing between others.
  double lost_length = 1;  ///< So many in a row, on average, if lengths fall geometrically.
  double unseen = 0;       ///< Share of the time that is in gaps too long to count as observed.
  bool cut = false;        ///< There are more segments than robots:
  SegmentLengths segments;

  /// Share of the windows of a lag [frames] that cuts leave.
  [[nodiscard]] double covered(double lag) const { return cut ? segments.covered(lag) : 1; }
};

/// What there is of a simulated recording: for each frame the stretch in which it lies, which
/// windows do not leave. -1: the frame is missing.
struct RecordingStretches {
  std::vector<int> of_places;
  std::vector<int> of_headings;  ///< Across longer gaps a heading is ambiguous.
};

/// @param frame_period of the measured recording, s
/// @param period of the simulated one, s, with so many frames
[[nodiscard]] RecordingStretches drawStretches(const RecordingGaps& gaps, double frame_period,
                                               double period, std::size_t frames,
                                               std::uint64_t seed);

}  // namespace lab::analysis
