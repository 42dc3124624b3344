/// Limits of an 8-bit camera.
#pragma once

namespace lab::detector {

inline constexpr float kMaxDn = 255;  ///< largest pixel value
/// [DN] expected value above which a pixel is saturated, or nearly so
inline constexpr float kSaturated = 253;
/// [DN] lowest value of a clipped pixel, including noise
inline constexpr float kNearlySaturated = 240;

}  // namespace lab::detector
