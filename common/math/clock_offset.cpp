#include "common/math/clock_offset.hpp"

#include <algorithm>
#include <vector>

#include "light/median.hpp"

namespace lab {
namespace {

/// Clocks of computers drift by up to 100 ppm: 1 ms in this time [us].
constexpr std::int64_t kOldestTrip_us = 10'000'000;
/// Upper limit of a round trip [us]; prevents overflow of the sums below.
constexpr std::int64_t kLongestTrip_us = 60'000'000;

bool within(std::int64_t from, std::int64_t to) {
  return from > 0 && to >= from && to - from <= kLongestTrip_us;
}

}  // namespace

void ClockOffsetEstimator::add(std::int64_t sent, std::int64_t there, std::int64_t answered,
                               std::int64_t came) {
  if (!within(sent, came) || !within(there, answered)) return;
  const std::int64_t delay = (came - sent) - (answered - there);
  if (delay < 0) return;
  const double offset =
      0.5 * (static_cast<double>(there - sent) + static_cast<double>(answered - came));
  // Old round trips are removed only if there are others, so a known offset stays known.
  while (last_.size() >= kWindow ||
         (last_.size() >= kEnough && came - last_.front().came > kOldestTrip_us)) {
    last_.pop_front();
  }
  last_.push_back({came, delay, offset});
}

ClockOffset ClockOffsetEstimator::estimate() const {
  if (last_.size() < kEnough) return {};
  std::vector<std::int64_t> delays;
  for (const RoundTrip& trip : last_) delays.push_back(trip.delay);
  const auto fastest = std::min_element(
      last_.begin(), last_.end(), [](const auto& a, const auto& b) { return a.delay < b.delay; });
  return {fastest->offset * 1e-6, 0.5e-6 * static_cast<double>(fastest->delay),
          1e-6 * static_cast<double>(medianOf(delays))};
}

}  // namespace lab
