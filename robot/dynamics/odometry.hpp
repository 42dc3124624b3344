#pragma once

#include <stdint.h>

#include "robot/dynamics/motor.hpp"

namespace lab {
namespace dynamics {

/// What a robot knows of its own motion from the commanded wheel speeds, in exact integer sums.
class Odometry {
 public:
  /// Sets half the distance between the wheels. Without one (0 or less) the heading stays 0.
  void setHalfWheelBase(int32_t half_wheel_base_um) {
    constexpr uint64_t kPerNanometre = 1467945250823553ULL;  // 2^64 / (4000 pi)
    const uint32_t half = half_wheel_base_um > 0 ? static_cast<uint32_t>(half_wheel_base_um) : 0U;
    turns_per_nm_ = half == 0 ? 0 : (kPerNanometre + half / 2U) / half;
  }

  void reset() {
    turned_nm_ = 0;
    driven_nm_ = 0;
  }

  /// Adds a motion at constant wheel speeds.
  void add(int32_t left_um_s, int32_t right_um_s, uint32_t ms) {
    const int32_t difference = wrappingDifference(right_um_s, left_um_s);
    const uint64_t turned_nm = static_cast<uint64_t>(absoluteSpeed(difference)) * ms;
    turned_nm_ = difference < 0 ? turned_nm_ - turned_nm : turned_nm_ + turned_nm;
    driven_nm_ += static_cast<uint64_t>(absoluteSpeed(wrappingSum(left_um_s, right_um_s))) * ms;
  }

  /// The heading's change since reset() [2^-32 turns], counter-clockwise.
  uint32_t headingTurns() const {
    return static_cast<uint32_t>((turned_nm_ * turns_per_nm_) >> 32);
  }

  /// The length of the path of the robot's centre since reset(), at most 549 m, which is more than
  /// the largest number of a program.
  uint32_t distanceUm() const {
    constexpr uint32_t kUmOf256HalfNm = 549755814UL;  // 0.128 in units of 2^-32
    const uint32_t most = 0xFFFFFFFFUL;
    const uint32_t driven = driven_nm_ >> 40 != 0 ? most : static_cast<uint32_t>(driven_nm_ >> 8);
    return static_cast<uint32_t>((static_cast<uint64_t>(driven) * kUmOf256HalfNm) >> 32);
  }

 private:
  uint64_t turned_nm_ = 0;     ///< Right wheel's path minus the left one's; wraps around.
  uint64_t driven_nm_ = 0;     ///< Twice the length of the path.
  uint64_t turns_per_nm_ = 0;  ///< [2^-64 turns / nm]
};

}  // namespace dynamics
}  // namespace lab
