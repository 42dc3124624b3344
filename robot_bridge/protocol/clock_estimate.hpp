/// Estimates offset and rate of a robot's clock against the host's. ClockOffsetEstimator, which is
/// for hosts, is not suitable: a robot's oscillator needs a fitted rate, and frames take long on
/// the wire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace lab::bridge {

/// Offset and rate of a robot's millisecond clock, from round trips (PING and PONG).
///
/// Each round trip bounds the host time of the robot's reading from both sides: it is after the
/// request was sent plus the request's time on the wire, and before the answer came minus the
/// answer's time on the wire. The middle of this interval is the sample, half its width the bound.
/// The estimate is a straight line fitted to the samples of the last minute, weighted by 1/bound^2.
///
/// The robot's 32-bit milliseconds wrap around after 49.7 days. A reading is taken as the one
/// nearest to the last sample.
class ClockEstimate {
 public:
  /// @param sent_utime, came_utime of the round trip, host time [us]
  /// @param robot_us the robot's clock during the round trip [us], below 2^32 ms
  /// @param request_us, answer_us durations of the frames on the wire [us]
  void add(std::int64_t sent_utime, std::int64_t came_utime, std::uint64_t robot_us,
           std::int64_t request_us, std::int64_t answer_us);

  /// Adds an unsolicited reading. It only gives an upper bound, because it was taken at an unknown
  /// time before its arrival. Ignored once there is a round trip.
  void addReading(std::int64_t came_utime, std::uint32_t robot_ms, std::int64_t answer_us);

  /// Forgets everything: the robot has restarted, or it is another one.
  void reset();

  [[nodiscard]] bool known() const { return heard_; }

  /// Host time of a reading of the robot's clock [us]. Without any sample: 0.
  [[nodiscard]] std::int64_t utimeOf(std::uint32_t robot_ms) const;

  /// Bound of the error of utimeOf() at this reading [us], from the round trips. Asymmetric delays
  /// outside the wire are not included.
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
  double rate_error_ = 0;  ///< [1]
  double ref_error_ = 0;   ///< [us] at the reference
};

}  // namespace lab::bridge
