/// A robot's clock against the host's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace lab::bridge {

/// Offset and rate of a robot's millisecond clock, from round trips (PING and PONG).
///
/// Each round trip bounds the robot's clock from both sides: its reading was taken after the
/// request was sent plus the time it spent on the wire, and before the answer came minus likewise.
/// The middle is the sample, half the width its bound. A straight line through the samples of the
/// last minute, weighted by their bounds, is the clock.
///
/// The 32-bit milliseconds wrap around after 49.7 days: a reading within 24 days of the last sample
/// is meant.
class ClockEstimate {
 public:
  /// @param sent_utime, came_utime of the round trip, host time [us]
  /// @param robot_us the robot's clock within it [us], below 2^32 ms
  /// @param request_us, answer_us what the frames take on the wire [us]
  void add(std::int64_t sent_utime, std::int64_t came_utime, std::uint64_t robot_us,
           std::int64_t request_us, std::int64_t answer_us);

  /// A reading that came without being asked for, when nothing better is known: it was not taken
  /// later than this.
  void hear(std::int64_t came_utime, std::uint32_t robot_ms, std::int64_t answer_us);

  /// The robot has restarted, or it is another one.
  void reset();

  [[nodiscard]] bool known() const { return heard_; }

  /// Host time of a reading of the robot's clock [us]. Without any sample: 0.
  [[nodiscard]] std::int64_t utimeOf(std::uint32_t robot_ms) const;

  /// What utimeOf() may be wrong by at this reading [us], so far as the round trips can tell.
  [[nodiscard]] double uncertainty(std::uint32_t robot_ms) const;

  /// Host seconds for one second of the robot's clock [1].
  [[nodiscard]] double rate() const { return rate_; }

 private:
  struct Sample {
    std::int64_t robot_us;  ///< unwrapped
    std::int64_t utime;
    double bound;  ///< [us]
  };

  [[nodiscard]] std::int64_t unwrap(std::uint64_t robot_us) const;
  void fit();

  std::deque<Sample> samples_;
  bool heard_ = false;
  bool measured_ = false;
  std::int64_t robot_ref_ = 0;  ///< [us] the line goes through (robot_ref_, host_ref_)
  std::int64_t host_ref_ = 0;   ///< [us]
  double rate_ = 1;
  double rate_error_ = 0;  ///< [1] of rate_
  double ref_error_ = 0;   ///< [us] at the reference
};

}  // namespace lab::bridge
