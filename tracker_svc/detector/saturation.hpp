/// What an 8-bit camera cannot say.
#pragma once

namespace lab::detector {

inline constexpr float kMaxDn = 255;      ///< no pixel says more
inline constexpr float kSaturated = 253;  ///< [DN] expected above: clipped, or nearly so
inline constexpr float kNearlySaturated =
    240;  ///< [DN] a clipped pixel never reads less, with noise

}  // namespace lab::detector
