/// Offset between the clock of another host and ours. For a robot's clock, whose rate must be
/// fitted too: robot_bridge/protocol/clock_estimate.hpp.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>

namespace lab {

/// The other clock minus ours. nan: not known yet.
struct ClockOffset {
  double offset = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  double error =
      std::numeric_limits<double>::quiet_NaN();  ///< [s] an upper bound, not a standard deviation
  double round_trip = std::numeric_limits<double>::quiet_NaN();  ///< [s] median of the last ones
};

/// NTP's formula (RFC 5905, section 8) on the fastest of the last round trips. A delay on one way
/// appears in the round trip, so the true offset is within half of the round trip.
class ClockOffsetEstimator {
 public:
  static constexpr std::size_t kWindow = 16;  ///< round trips that are kept
  static constexpr std::size_t kEnough = 6;   ///< round trips before estimate() gives a result

  /// Our request left at `sent` and arrived there at `there`; the answer left at `answered` and
  /// arrived here at `came`; the middle two by the other clock [us since 1970]. Impossible times
  /// (an answer before its request) are ignored.
  void add(std::int64_t sent, std::int64_t there, std::int64_t answered, std::int64_t came);

  [[nodiscard]] ClockOffset estimate() const;

 private:
  struct RoundTrip {
    std::int64_t came;   ///< [us since 1970]
    std::int64_t delay;  ///< [us]
    double offset;       ///< [us]
  };
  std::deque<RoundTrip> last_;
};

}  // namespace lab
