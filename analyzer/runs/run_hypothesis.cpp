#include "analyzer/runs/run_hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analyzer/bootstrap/simulated_recording.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr std::size_t kFewest = 8;
constexpr std::size_t kMostSimulated = 500;  // waiting times of a replicate

/// Stephens' modified statistic for the exponential law with fitted rate. Sorts its argument.
double lilliefors(std::vector<WaitingTime>& waiting) {
  std::sort(waiting.begin(), waiting.end(),
            [](const WaitingTime& a, const WaitingTime& b) { return a.time < b.time; });
  double sum = 0;
  double events = 0;
  for (const WaitingTime& one : waiting) {
    sum += one.time;
    events += one.ended ? 1 : 0;
  }
  const double rate = events / sum;
  double survival = 1;
  double distance = 0;
  auto at_risk = static_cast<double>(waiting.size());
  for (const WaitingTime& one : waiting) {
    if (one.ended) {
      const double law = std::exp(-rate * one.time);
      distance = std::max(distance, std::abs(survival - law));
      survival *= 1 - 1 / at_risk;
      distance = std::max(distance, std::abs(survival - law));
    }
    at_risk -= 1;
  }
  const double root = std::sqrt(events);
  return (distance - 0.2 / events) * (root + 0.26 + 0.5 / root);
}

/// The total time of each track, in order of their numbers.
std::vector<double> budgets(std::span<const WaitingTime> waiting) {
  std::vector<double> all;
  int track = -1;
  for (const WaitingTime& one : waiting) {
    if (one.track != track || all.empty()) {
      track = one.track;
      all.push_back(0);
    }
    all.back() += one.time;
  }
  return all;
}

}  // namespace

TestResult exponentialTest(std::span<const WaitingTime> waiting, std::uint64_t seed,
                           int replicates) {
  std::vector<WaitingTime> sorted(waiting.begin(), waiting.end());
  const auto events = static_cast<std::size_t>(std::count_if(
      sorted.begin(), sorted.end(), [](const WaitingTime& one) { return one.ended; }));
  if (events < kFewest) {
    return {kNan, kNan, static_cast<double>(events)};
  }
  const std::vector<double> tracks = budgets(waiting);
  const double statistic = lilliefors(sorted);
  double sum = 0;
  for (const double track : tracks) {
    sum += track;
  }
  const double rate = static_cast<double>(events) / sum;
  Random random(seed);
  int beyond = 0;
  std::vector<WaitingTime> simulated;
  for (int r = 0; r < replicates; ++r) {
    // Fills every track with waiting times until it ends. Part of the tracks is sufficient.
    simulated.clear();
    std::size_t ended = 0;
    auto track = static_cast<std::size_t>(random.uniform() * static_cast<double>(tracks.size()));
    for (std::size_t t = 0; t < tracks.size() && simulated.size() < kMostSimulated; ++t) {
      double left = tracks[track++ % tracks.size()];
      while (left > 0 && simulated.size() < kMostSimulated) {
        const double time = random.exponential(rate);
        simulated.push_back({std::min(time, left), time < left, 0});
        ended += time < left ? 1 : 0;
        left -= time;
      }
    }
    beyond += ended > 1 && lilliefors(simulated) >= statistic ? 1 : 0;
  }
  return {statistic, (1.0 + beyond) / (1.0 + replicates), static_cast<double>(events)};
}

TestResult kuiperTest(std::span<const double> angles) {
  const auto n = static_cast<double>(angles.size());
  if (angles.size() < kFewest) {
    return {kNan, kNan, n};
  }
  std::vector<double> turns;
  turns.reserve(angles.size());
  for (const double angle : angles) {
    const double turn = angle / (2 * std::numbers::pi);
    turns.push_back(turn - std::floor(turn));
  }
  std::sort(turns.begin(), turns.end());
  double above = 0;
  double below = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    above = std::max(above, static_cast<double>(i + 1) / n - turns[i]);
    below = std::max(below, turns[i] - static_cast<double>(i) / n);
  }
  const double root = std::sqrt(n);
  const double v = (above + below) * (root + 0.155 + 0.24 / root);
  double p = 0;
  for (int j = 1; j < 100; ++j) {
    const double jv2 = j * j * v * v;
    p += 2 * (4 * jv2 - 1) * std::exp(-2 * jv2);
  }
  return {v, v < 0.4 ? 1.0 : std::clamp(p, 0.0, 1.0), n};
}

TestResult rayleighTest(std::span<const double> angles) {
  const auto n = static_cast<double>(angles.size());
  if (angles.size() < kFewest) {
    return {kNan, kNan, n};
  }
  double c = 0;
  double s = 0;
  for (const double angle : angles) {
    c += std::cos(angle);
    s += std::sin(angle);
  }
  const double r2 = c * c + s * s;
  const double p = std::exp(std::sqrt(1 + 4 * n + 4 * (n * n - r2)) - (1 + 2 * n));
  return {std::sqrt(r2) / n, std::clamp(p, 0.0, 1.0), n};
}

TestResult correlationTest(std::span<const double> a, std::span<const double> b) {
  const auto n = static_cast<double>(a.size());
  if (a.size() < kFewest || a.size() != b.size()) {
    return {kNan, kNan, n};
  }
  double sa = 0;
  double sb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sa += a[i];
    sb += b[i];
  }
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - sa / n) * (a[i] - sa / n);
    bb += (b[i] - sb / n) * (b[i] - sb / n);
    ab += (a[i] - sa / n) * (b[i] - sb / n);
  }
  if (!(aa > 0) || !(bb > 0)) {
    return {kNan, kNan, n};
  }
  const double r = ab / std::sqrt(aa * bb);
  return {r, std::erfc(std::abs(r) * std::sqrt((n - 1) / 2)), n};
}

}  // namespace lab::analysis
