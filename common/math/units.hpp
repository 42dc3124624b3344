/// Where people read and write, lengths are centimetres and angles degrees; inside, all is SI.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

namespace lab::units {

inline constexpr double kCentimetre = 0.01;                ///< [m]
inline constexpr double kDegree = std::numbers::pi / 180;  ///< [rad]
inline constexpr double kMillisecond = 1e-3;               ///< [s]
inline constexpr double kPercent = 0.01;                   ///< [1]
inline constexpr double kCm = 100;        ///< [cm] in a metre: exact, as 1 / kCentimetre is not
inline constexpr double kPercents = 100;  ///< in a whole
inline constexpr std::int64_t kMillisecond_us = 1'000;  ///< [us]
inline constexpr std::int64_t kSecond_us = 1'000'000;   ///< [us]

/// Seconds between two utimes.
constexpr double seconds(std::int64_t utime_difference) {
  return static_cast<double>(utime_difference) * 1e-6;
}

/// Whole microseconds, rounded to the nearest.
constexpr std::int64_t microseconds(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e6 + (seconds < 0 ? -0.5 : 0.5));
}

/// What was not measured.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace lab::units
