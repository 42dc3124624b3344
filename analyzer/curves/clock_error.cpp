#include "analyzer/curves/clock_error.hpp"

#include <cmath>

namespace lab::analysis {

void widenByClocks(Estimate& estimate, double robots, double power) {
  if (!std::isfinite(estimate.value) || !(estimate.sigma > 0) || !(robots > 0)) return;
  const double clock = power * kClockError * std::abs(estimate.value) / std::sqrt(robots);
  const double factor = std::hypot(estimate.sigma, clock) / estimate.sigma;
  estimate.sigma *= factor;
  if (estimate.low95 > 0) {  // of a positive number: the interval of its logarithm
    estimate.low95 = estimate.value * std::pow(estimate.low95 / estimate.value, factor);
    estimate.high95 = estimate.value * std::pow(estimate.high95 / estimate.value, factor);
  } else {
    estimate.low95 = estimate.value + factor * (estimate.low95 - estimate.value);
    estimate.high95 = estimate.value + factor * (estimate.high95 - estimate.value);
  }
}

}  // namespace lab::analysis
