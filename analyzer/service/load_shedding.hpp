/// What the online analyzer leaves out when it cannot keep up.
#pragma once

#include <algorithm>
#include <cstdint>

namespace lab::analysis {

/// Decides what an overloaded analyzer does not do. First it computes results less often: after
/// each time it pauses three times as long, at most 30 s, and while messages wait. If messages
/// nevertheless wait for longer than kLongestBacklog_us, whole camera frames are left out until the
/// backlog is gone. States of robots are always taken. It has no clock: times and backlogs are
/// arguments [us]. In virtual time nothing takes time, and nothing is left out.
class LoadShedding {
 public:
  /// Messages that wait for less are no backlog.
  static constexpr std::int64_t kNoBacklog_us = 500'000;
  /// Limit of the backlog, beside the time that the last results took. Less than what the queue of
  /// the bus holds (64 MB) with 400 robots at 100 frames/s.
  static constexpr std::int64_t kLongestBacklog_us = 5'000'000;

  /// Whether results are to be computed.
  [[nodiscard]] bool isDue(std::int64_t now, std::int64_t backlog) const {
    return now >= next_utime_ && backlog <= kNoBacklog_us;
  }

  /// Results were computed, or are being computed since `begin`.
  /// @param intended time between results without overload
  /// @return whether the time between them is twice as long as longest() was
  [[nodiscard]] bool computed(std::int64_t begin, std::int64_t end,
                              std::int64_t intended = kSecond_us) {
    duration_us_ = end - begin;
    // The machine may be free again after a long while.
    const std::int64_t planned_us = duration_us_ + std::min(kRest * duration_us_, kLongestRest_us);
    const std::int64_t late_us = last_utime_ == 0 ? 0 : begin - last_utime_ - intended;
    next_utime_ = begin + planned_us;
    last_utime_ = begin;
    const std::int64_t seconds =
        std::max((planned_us + kSecond_us - 1) / kSecond_us, late_us / kSecond_us + 1);
    if (seconds < 2 * longest_s_) return false;
    longest_s_ = seconds;
    return true;
  }

  /// Whether the camera frame that has arrived is analyzed. Frames are left out in one piece, not
  /// evenly, because short lags need successive frames.
  [[nodiscard]] bool takesFrame(std::int64_t backlog) {
    leaving_out_ = backlog > (leaving_out_ ? kNoBacklog_us : kLongestBacklog_us + duration_us_);
    ++frames_;
    if (leaving_out_) ++left_out_;
    return !leaving_out_;
  }

  /// The longest time between results [s]; at least 1.
  [[nodiscard]] std::int64_t longest() const { return longest_s_; }
  [[nodiscard]] std::int64_t frames() const { return frames_; }     ///< received
  [[nodiscard]] std::int64_t leftOut() const { return left_out_; }  ///< of them

  /// Whether twice as many frames were left out as at the last call that returned true.
  [[nodiscard]] bool hasLeftOutMore() {
    if (left_out_ == 0 || left_out_ < 2 * said_) return false;
    said_ = left_out_;
    return true;
  }

 private:
  static constexpr std::int64_t kRest = 3;  // times the duration
  static constexpr std::int64_t kLongestRest_us = 30'000'000;
  static constexpr std::int64_t kSecond_us = 1'000'000;
  std::int64_t next_utime_ = 0;
  std::int64_t last_utime_ = 0;   ///< begin of the last results; 0: none
  std::int64_t duration_us_ = 0;  ///< of computing them
  std::int64_t longest_s_ = 1;    ///< between results
  std::int64_t frames_ = 0;
  std::int64_t left_out_ = 0;
  std::int64_t said_ = 0;
  bool leaving_out_ = false;
};

}  // namespace lab::analysis
