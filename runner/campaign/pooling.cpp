#include "runner/campaign/pooling.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/math/units.hpp"

namespace lab::runner::campaign {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewestPoints = 5;  // with several runs, for a prior
constexpr double kUnseenShare = 0.75;     // of the standard error of the variance between points
constexpr double kNormal = 1.959963984540054;
constexpr double kAsGoodAsInfinite = 1e6;  // degrees of freedom

/// What the runs of one point say about their variance.
struct Scatter {
  std::vector<RunNumber> runs;
  double mean = 0;
  double within = 0;          ///< mean squared error of the runs; 0: not known
  double within_freedom = 0;  ///< degrees of freedom of `within`
  double freedom = 0;         ///< of `ratio`
  double ratio = 0;           ///< sample variance over `within`
};

Scatter scatterOf(const std::vector<RunNumber>& all) {
  Scatter scatter;
  for (const RunNumber& run : all) {
    if (std::isfinite(run.value)) scatter.runs.push_back(run);
  }
  const auto count = static_cast<double>(scatter.runs.size());
  bool errors = !scatter.runs.empty();
  bool samples = true;
  for (const RunNumber& run : scatter.runs) {
    scatter.mean += run.value / count;
    scatter.within += run.sigma * run.sigma / count;
    errors = errors && std::isfinite(run.sigma) && run.sigma > 0;
    samples = samples && run.effective_samples > 1;
    scatter.within_freedom += run.effective_samples - 1;
  }
  if (!errors) scatter.within = 0;
  if (!samples) scatter.within_freedom = kInfinite;
  scatter.freedom = std::max(0.0, count - 1);
  double squares = 0;
  for (const RunNumber& run : scatter.runs) {
    squares += (run.value - scatter.mean) * (run.value - scatter.mean);
  }
  if (scatter.freedom > 0) {
    scatter.ratio = squares / scatter.freedom / (errors ? scatter.within : 1);
  }
  return scatter;
}

/// The prior of the ratios: a scaled inverse chi-square distribution.
struct Prior {
  double freedom = 0;  ///< 0: there is no prior
  double ratio = 1;
  double all = kInfinite;  ///< degrees of freedom of all points together
};

/// x with trigamma(x) = y (Newton's method on 1 / trigamma, as in limma).
double inverseTrigamma(double y) {
  double x = 0.5 + 1 / y;
  for (int i = 0; i < 50; ++i) {
    const double tri = boost::math::trigamma(x);
    const double h = 1e-5 * x;
    const double slope = (boost::math::trigamma(x + h) - boost::math::trigamma(x - h)) / (2 * h);
    const double step = tri * (1 - tri / y) / slope;
    x += step;
    if (std::abs(step) < 1e-9 * x) break;
  }
  return x;
}

Prior priorOf(const std::vector<Scatter>& points) {
  std::vector<double> logs;
  double freedom = 0;
  double noise = 0;  // variance of the logs for points of equal variance
  for (const Scatter& point : points) {
    if (point.freedom <= 0 || point.within <= 0 || point.ratio <= 0) continue;
    const double half = point.freedom / 2;
    logs.push_back(std::log(point.ratio) - boost::math::digamma(half) + std::log(half));
    noise += boost::math::trigamma(half);
    freedom += point.freedom;
  }
  Prior prior;
  if (logs.size() < kFewestPoints) return prior;
  const auto count = static_cast<double>(logs.size());
  double mean = 0;
  for (const double log : logs) mean += log / count;
  double variance = 0;
  for (const double log : logs) variance += (log - mean) * (log - mean) / (count - 1);
  // Few points may look equal by chance: differences that they could not show are allowed for.
  const double excess = variance - noise / count;
  const double unseen = kUnseenShare * std::sqrt(2 / (count - 1)) * noise / count;
  prior.all = freedom;
  prior.freedom = 2 * inverseTrigamma(std::max(excess, unseen));
  if (excess > 0) {
    const double half = prior.freedom / 2;
    prior.ratio = std::exp(mean + boost::math::digamma(half) - std::log(half));
  } else {
    // The mean of equal ratios has less noise than that of their logarithms.
    prior.ratio = 0;
    for (const Scatter& point : points) {
      if (point.freedom > 0 && point.within > 0 && point.ratio > 0) {
        prior.ratio += point.freedom * point.ratio / freedom;
      }
    }
  }
  return prior;
}

double quantile(double freedom) {
  if (!(freedom < kAsGoodAsInfinite)) return kNormal;
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 0.5)), 0.975);
}

PooledNumber ownInterval(const Scatter& point) {
  const RunNumber& run = point.runs.front();
  const bool sigma = std::isfinite(run.sigma) && run.sigma > 0;
  return {1,         run.value,  sigma ? run.sigma : units::kNan, run.low95, run.high95,
          kInfinite, units::kNan};
}

PooledNumber pooled(const Scatter& point, const Prior& prior) {
  if (point.runs.empty()) {
    return {0, units::kNan, units::kNan, units::kNan, units::kNan, 0, units::kNan};
  }
  const bool with_prior = prior.freedom > 0 && point.within > 0;
  if (point.freedom <= 0 && !with_prior) return ownInterval(point);
  const double within = point.within > 0 ? point.within : 1;
  double ratio = point.ratio;
  double freedom = point.freedom;
  if (with_prior) {
    ratio = (prior.freedom * prior.ratio + point.freedom * point.ratio) /
            (prior.freedom + point.freedom);
    freedom = std::min(prior.freedom + point.freedom, prior.all);
    freedom = 1 / (1 / freedom + 1 / point.within_freedom);
  }
  const auto count = static_cast<double>(point.runs.size());
  PooledNumber number;
  number.runs = static_cast<int>(point.runs.size());
  number.mean = point.mean;
  number.sigma = std::sqrt(ratio * within / count);
  number.degrees_of_freedom = freedom;
  const double half = quantile(freedom) * number.sigma;
  number.low95 = number.mean - half;
  number.high95 = number.mean + half;
  number.between = point.within > 0 ? std::sqrt(std::max(0.0, (ratio - 1) * within)) : units::kNan;
  return number;
}

}  // namespace

std::vector<PooledNumber> pool(const std::vector<std::vector<RunNumber>>& points) {
  std::vector<Scatter> scatters;
  scatters.reserve(points.size());
  for (const std::vector<RunNumber>& runs : points) scatters.push_back(scatterOf(runs));
  const Prior prior = priorOf(scatters);
  std::vector<PooledNumber> numbers;
  numbers.reserve(points.size());
  for (const Scatter& point : scatters) numbers.push_back(pooled(point, prior));
  return numbers;
}

}  // namespace lab::runner::campaign
