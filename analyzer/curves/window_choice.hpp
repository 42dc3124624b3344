/// Which windows of a lag count: below 16 frames all, from there on one every (lag/16 to lag/8)
/// frames, chosen by the golden ratio so that no program's clock can lock to the choice. Measured
/// curves and those of simulated recordings go by the same choice, as curves err together by it.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace lab::analysis {

inline constexpr int kEveryLags = 16;  ///< [frames] below, every window counts
inline constexpr int kDenseLags =
    64;  ///< [frames] below, the choice is of end frames; else of begins

/// Below 64 frames: log2 of the distance between the end frames used for a lag, on average.
[[nodiscard]] inline std::size_t stepOf(int lag) {
  return lag < kEveryLags ? 0 : lag < 2 * kEveryLags ? 1 : 2;
}

/// Windows of all dense lags with this step, or a lower one, end at this frame.
[[nodiscard]] inline std::size_t mostStepAt(std::uint64_t slot) {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(std::countl_zero(slot * kGoldenRatio));
}

/// From 64 frames on: 0 up to 127, then one more an octave.
[[nodiscard]] inline int octaveOf(int lag) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(lag))) - 7;
}

/// Frames between the begins of an octave's windows, on average.
[[nodiscard]] inline double strideOf(int octave) {
  return std::ldexp(5 * std::numbers::phi, octave);
}

}  // namespace lab::analysis
