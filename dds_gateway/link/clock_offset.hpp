/// The clock of another host against ours.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>

namespace lab::gateway {

/// Its clock minus ours. nan: not known yet.
struct ClockOffset {
  double offset = std::numeric_limits<double>::quiet_NaN();      ///< [s]
  double error = std::numeric_limits<double>::quiet_NaN();       ///< [s] a bound, not a deviation
  double round_trip = std::numeric_limits<double>::quiet_NaN();  ///< [s] median of the last ones
};

/// NTP's formula (RFC 5905, section 8) on the fastest of the last round trips: whatever delays a
/// message on one way shows in its round trip, and the true offset is within half of that.
class ClockOffsetEstimator {
 public:
  static constexpr std::size_t kWindow = 16;  ///< round trips that are kept
  static constexpr std::size_t kEnough = 6;   ///< before anything is said

  /// Our request left at `sent`, came there at `there`, was answered at `answered`, and the answer
  /// came here at `came`; the middle two by the other clock [us since 1970]. What cannot have
  /// happened (an answer before its request) is ignored.
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

}  // namespace lab::gateway
