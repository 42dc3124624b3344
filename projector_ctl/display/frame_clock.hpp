/// The frame times of a display.
#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace lab::projector {

/// Frame boundaries of a display: boundary n is n / rate seconds after 1970, rounded to the nearest
/// microsecond. They are computed in integers from 1970 on, so they do not drift and are the same
/// in every process.
class FrameClock {
 public:
  /// @param rate [Hz] 1 to 1000, rounded to the nearest millihertz.
  /// @throws std::invalid_argument for any other rate.
  explicit FrameClock(double rate = 60)
      : millihertz_(rate >= 1 && rate <= 1000
                        ? std::llround(rate * 1000)
                        : throw std::invalid_argument("frame rate: allowed are 1 to 1000 Hz")) {}

  /// [us since 1970] of boundary `number`, which is not negative.
  [[nodiscard]] std::int64_t boundary(std::int64_t number) const {
    const std::int64_t blocks = number / millihertz_;
    const std::int64_t rest = number % millihertz_;
    return blocks * kBlock + (rest * kBlock + millihertz_ / 2) / millihertz_;
  }

  /// Number of the first boundary at or after `utime` [us since 1970, not negative].
  [[nodiscard]] std::int64_t numberAtOrAfter(std::int64_t utime) const {
    std::int64_t number = utime / kBlock * millihertz_ + utime % kBlock * millihertz_ / kBlock;
    while (boundary(number) < utime) ++number;
    return number;
  }

  /// The first boundary at or after `utime`.
  [[nodiscard]] std::int64_t nextBoundary(std::int64_t utime) const {
    return boundary(numberAtOrAfter(utime));
  }

  /// [s]
  [[nodiscard]] double period() const { return 1000.0 / static_cast<double>(millihertz_); }

 private:
  /// 1000 s contain a whole number of frames for any whole number of millihertz. The products with
  /// this number fit into 64 bits.
  static constexpr std::int64_t kBlock = 1'000'000'000;  // [us]

  std::int64_t millihertz_;
};

}  // namespace lab::projector
