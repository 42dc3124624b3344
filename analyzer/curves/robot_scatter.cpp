#include "analyzer/curves/robot_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "analyzer/curves/statistics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

RobotScatter scatterOfRobots(std::span<const double> values, std::span<const double> weights) {
  double all = 0;
  double mean = 0;
  int robots = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || !(weights[i] > 0)) continue;
    all += weights[i];
    mean += weights[i] * values[i];
    ++robots;
  }
  if (robots < 2) return {units::kNan, 0};
  mean /= all;
  double variance = 0;
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || !(weights[i] > 0)) continue;
    const double share = weights[i] / all;
    const double off = values[i] - mean;
    variance += share * share * off * off / (1 - share);
    squares += share * share;
  }
  return {std::sqrt(variance), std::max(1.0, 1 / squares - 1)};
}

void widenTo(Estimate& pool, const RobotScatter& scatter) {
  if (!std::isfinite(pool.value) || !(scatter.sigma > 0)) return;
  const bool positive = pool.low95 > 0;
  const double half = studentQuantile95(scatter.freedom) * scatter.sigma;
  const double low = positive ? pool.value * std::exp(-half) : pool.value - half;
  const double high = positive ? pool.value * std::exp(half) : pool.value + half;
  pool.sigma = std::max(pool.sigma, (positive ? pool.value : 1) * scatter.sigma);
  pool.low95 = std::min(pool.low95, low);
  pool.high95 = std::max(pool.high95, high);
}

void widenByRobots(Estimate& pool, std::span<const Estimate* const> robots,
                   std::span<const double> weights) {
  const bool positive = pool.low95 > 0;
  std::vector<double> values;
  for (const Estimate* robot : robots) {
    if (robot == nullptr || (positive && !(robot->value > 0))) {
      values.push_back(units::kNan);
    } else {
      values.push_back(positive ? std::log(robot->value) : robot->value);
    }
  }
  widenTo(pool, scatterOfRobots(values, weights));
}

void widenByRobots(std::vector<Estimate>& pool,
                   const std::vector<const std::vector<Estimate>*>& robots,
                   const std::vector<double>& weights) {
  for (Estimate& estimate : pool) {
    std::vector<const Estimate*> same;
    for (const std::vector<Estimate>* robot : robots) {
      const auto found = std::ranges::find(*robot, estimate.name, &Estimate::name);
      same.push_back(found == robot->end() ? nullptr : &*found);
    }
    widenByRobots(estimate, same, weights);
  }
}

}  // namespace lab::analysis
