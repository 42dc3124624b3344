/// What an 8-bit camera cannot say.
#pragma once

namespace lab::detector {

inline constexpr float kMostDN = 255;       ///< no pixel says more
inline constexpr float kFull = 253;         ///< [DN] expected above: clipped, or nearly so
inline constexpr float kNearlyFull = 240;   ///< [DN] a clipped pixel never reads less, with noise

}  // namespace lab::detector
