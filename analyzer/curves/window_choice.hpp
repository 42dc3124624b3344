/// Selects the windows of a lag: all below 16 frames, above that one in every (lag/16 to lag/8)
/// frames. The golden ratio prevents that the selection locks to the clock of a program. Measured
/// and simulated curves use the same selection, because it correlates the errors of lags.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace lab::analysis {

inline constexpr int kEveryLags = 16;  ///< [frames] below, all windows are used
inline constexpr int kDenseLags = 64;  ///< [frames] below, end frames are chosen; else first frames

/// Below 64 frames: log2 of the mean distance between the end frames used for a lag.
[[nodiscard]] inline std::size_t stepOf(int lag) {
  return lag < kEveryLags ? 0 : lag < 2 * kEveryLags ? 1 : 2;
}

/// The largest step of the dense lags whose windows end at this frame.
[[nodiscard]] inline std::size_t mostStepAt(std::uint64_t slot) {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(std::countl_zero(slot * kGoldenRatio));
}

/// From 64 frames on: 0 up to 127 frames, then one more per octave.
[[nodiscard]] inline int octaveOf(int lag) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(lag))) - 7;
}

/// Mean distance in frames between the beginnings of windows of an octave.
[[nodiscard]] inline double strideOf(int octave) {
  return std::ldexp(5 * std::numbers::phi, octave);
}

}  // namespace lab::analysis
