/// Conversion of units. Messages and code use SI; files and displays use centimetres and degrees.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

namespace lab::units {

inline constexpr double kCentimetre = 0.01;                ///< [m]
inline constexpr double kDegree = std::numbers::pi / 180;  ///< [rad]
inline constexpr double kMillisecond = 1e-3;               ///< [s]
inline constexpr double kPercent = 0.01;                   ///< [1]
inline constexpr double kCm = 100;                         ///< [cm/m] exact, unlike 1 / kCentimetre
inline constexpr double kPercents = 100;                   ///< [%] per unit
inline constexpr std::int64_t kMillisecond_us = 1'000;     ///< [us]
inline constexpr std::int64_t kSecond_us = 1'000'000;      ///< [us]

/// Seconds between two utimes.
constexpr double seconds(std::int64_t utime_difference) {
  return static_cast<double>(utime_difference) * 1e-6;
}

/// Whole microseconds, rounded to the nearest.
constexpr std::int64_t microseconds(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e6 + (seconds < 0 ? -0.5 : 0.5));
}

/// A value that was not measured.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace lab::units
