#include "robot_bridge/protocol/clock_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace lab::bridge {
namespace {

constexpr std::int64_t kWindow_us = 60'000'000;
constexpr std::size_t kFewest = 3;                // samples needed to estimate the rate
constexpr std::int64_t kShortest_us = 2'000'000;  // time span of samples needed for the rate
constexpr double kClockTolerance = 0.01;          // [1] a ceramic resonator has 0.5 %
constexpr double kSmallestBound = 100;            // [us] jitter of the host
constexpr std::uint64_t kWrap_us = (std::uint64_t{1} << 32U) * 1000U;

}  // namespace

void ClockEstimate::reset() { *this = ClockEstimate(); }

// The reading nearest to the reference among those that wrap to the same 32-bit milliseconds.
std::int64_t ClockEstimate::unwrap(std::uint64_t robot_us) const {
  if (!heard_) return static_cast<std::int64_t>(robot_us);
  const std::int64_t wrap = static_cast<std::int64_t>(kWrap_us);
  std::int64_t ahead = (static_cast<std::int64_t>(robot_us % kWrap_us) - robot_ref_) % wrap;
  if (ahead < -wrap / 2) ahead += wrap;
  if (ahead >= wrap / 2) ahead -= wrap;
  return robot_ref_ + ahead;
}

void ClockEstimate::add(std::int64_t sent_utime, std::int64_t came_utime, std::uint64_t robot_us,
                        std::int64_t request_us, std::int64_t answer_us) {
  const std::int64_t earliest = sent_utime + request_us;
  const std::int64_t latest = came_utime - answer_us;
  Sample sample{};
  sample.robot_us = unwrap(robot_us);
  sample.utime = earliest + (latest - earliest) / 2;
  sample.bound = std::max(kSmallestBound, std::abs(static_cast<double>(latest - earliest)) / 2);
  samples_.push_back(sample);
  while (samples_.front().utime < sample.utime - kWindow_us) samples_.pop_front();
  heard_ = true;
  measured_ = true;
  fit();
}

void ClockEstimate::addReading(std::int64_t came_utime, std::uint32_t robot_ms,
                               std::int64_t answer_us) {
  if (measured_) return;
  const std::int64_t latest = came_utime - answer_us;
  const std::int64_t reading = unwrap(std::uint64_t{robot_ms} * 1000U);
  // Of several such readings the one with the shortest delay is the most accurate.
  if (heard_ && latest - reading >= host_ref_ - robot_ref_) return;
  robot_ref_ = reading;
  host_ref_ = latest;
  rate_error_ = kClockTolerance;
  ref_error_ = 100'000;  // it may have waited behind a few frames
  heard_ = true;
}

void ClockEstimate::fit() {
  double weight = 0;
  double mean_bound = 0;
  double mean_robot = 0;
  double mean_host = 0;
  const Sample& last = samples_.back();
  for (const Sample& sample : samples_) {
    const double w = 1 / (sample.bound * sample.bound);
    weight += w;
    mean_bound += w * sample.bound;
    mean_robot += w * static_cast<double>(sample.robot_us - last.robot_us);
    mean_host += w * static_cast<double>(sample.utime - last.utime);
  }
  mean_robot /= weight;
  mean_host /= weight;
  double spread = 0;
  double slope = 0;
  for (const Sample& sample : samples_) {
    const double w = 1 / (sample.bound * sample.bound);
    const double robot = static_cast<double>(sample.robot_us - last.robot_us) - mean_robot;
    spread += w * robot * robot;
    slope += w * robot * (static_cast<double>(sample.utime - last.utime) - mean_host);
  }
  const std::int64_t span = last.robot_us - samples_.front().robot_us;
  const bool rate_known = samples_.size() >= kFewest && span >= kShortest_us && spread > 0;
  rate_ = rate_known ? slope / spread : 1;
  rate_error_ = rate_known ? 1 / std::sqrt(spread) : kClockTolerance;
  if (std::abs(rate_ - 1) > kClockTolerance || rate_error_ > kClockTolerance) {
    rate_ = std::clamp(rate_, 1 - kClockTolerance, 1 + kClockTolerance);
    rate_error_ = kClockTolerance;
  }
  if (rate_known) {
    robot_ref_ = last.robot_us + std::llround(mean_robot);
    host_ref_ = last.utime + std::llround(mean_host);
    // Not divided by the square root of the number of samples, because a delay in one direction is
    // a systematic error.
    ref_error_ = mean_bound / weight;
  } else {  // without a rate, an average of old samples would lag behind the clock
    const Sample& best = *std::min_element(
        samples_.begin(), samples_.end(), [&last](const Sample& a, const Sample& b) {
          const auto width = [&last](const Sample& s) {
            return s.bound + kClockTolerance * static_cast<double>(last.robot_us - s.robot_us);
          };
          return width(a) < width(b);
        });
    robot_ref_ = best.robot_us;
    host_ref_ = best.utime;
    ref_error_ = best.bound;
  }
}

std::int64_t ClockEstimate::utimeOf(std::uint32_t robot_ms) const {
  if (!heard_) return 0;
  const std::int64_t since = unwrap(std::uint64_t{robot_ms} * 1000U) - robot_ref_;
  return host_ref_ + std::llround(rate_ * static_cast<double>(since));
}

double ClockEstimate::uncertainty(std::uint32_t robot_ms) const {
  const std::int64_t since = unwrap(std::uint64_t{robot_ms} * 1000U) - robot_ref_;
  return ref_error_ + rate_error_ * std::abs(static_cast<double>(since));
}

}  // namespace lab::bridge
