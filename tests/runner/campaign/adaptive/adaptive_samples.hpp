/// A campaign whose measurements have the noise of the physics, without simulation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/math/random.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign::adaptive_samples {

inline constexpr double kRunTime = 600;  // [s]

using Over = std::vector<std::string>;

/// The 6 x 5 points of experiments/diffusion_scan.toml.
inline const Over kShipped{"eta_rad_s=0.5,1,2,3,4.5,6", "epsilon_s=0.1,0.2,0.4,0.6,0.9"};

/// A uniform grid of 6 x 5 points.
inline const Over kUniform{"eta_rad_s=1:6:6", "epsilon_s=0.1:0.9:5"};

inline CampaignData scan(const AdaptivePlan& plan, std::int64_t seeds,
                         const Over& over = kShipped) {
  CampaignData data;
  data.request.file = "scan.toml";
  data.request.over = over;
  data.request.seeds = seeds;
  data.request.adaptive = plan;
  const Design design = data.request.design();
  data.axes = design.axes;
  for (const PointValues& values : pointsOf(design)) {
    data.points.push_back(
        makePoint(values, "eta " + values[0] + " epsilon " + values[1], kRunTime));
  }
  data.rows = rowsOf(data.request, data.points, {"1", 5});
  data.survey.rows.resize(data.rows.size());
  return data;
}

/// The keys of a point: eta and epsilon.
inline std::vector<double> keysOf(const CampaignData& data, std::size_t point) {
  return {std::stod(data.points[point].values[0]), std::stod(data.points[point].values[1])};
}

/// D_r = epsilon eta^2 / 6 (the paper, below eq. 4).
inline double truth(const CampaignData& data, std::size_t point) {
  const std::vector<double> keys = keysOf(data, point);
  return keys[1] * keys[0] * keys[0] / 6;
}

/// Measures D_r = epsilon <omega^2> / 2 of the turning rates omega, which are drawn uniformly from
/// -eta to eta each epsilon; its standard error by the scatter of their squares.
inline void run(CampaignData& data, std::size_t row, std::uint64_t seed) {
  const std::vector<double> keys = keysOf(data, data.rows[row].point);
  Random random(seed, row);
  const int draws =
      static_cast<int>(std::lround(data.points[data.rows[row].point].duration / keys[1]));
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < draws; ++i) {
    const double omega = keys[0] * (2 * random.uniform() - 1);
    const double one = keys[1] * omega * omega / 2;
    sum += one;
    squares += one * one;
  }
  const double mean = sum / draws;
  const double variance = (squares / draws - mean * mean) / (draws - 1);
  RunResult result;
  result.identity = data.rows[row].identity;
  result.columns = {{"abp.D_r_rad2_s", mean},
                    {"abp.D_r_rad2_s.standard_error", std::sqrt(variance)},
                    {"abp.D_r_rad2_s.effective_samples", static_cast<double>(draws)}};
  data.survey.rows[row] = {RowState::Kind::kDone, std::move(result), {}};
}

/// 13 x 5 points of a transition: an order parameter over a noise and a density.
inline const Over kTransition{"noise=0:1.2:13", "density=0.2:1:5"};

/// Where the order parameter is one half.
inline double transitionAt(double density) { return 0.2 + 0.7 * density; }

/// Measures the order parameter of a point with an error of 0.05, which the run states as such.
inline void runTransition(CampaignData& data, std::size_t row, std::uint64_t seed) {
  const std::vector<double> keys = keysOf(data, data.rows[row].point);
  Random random(seed, row);
  constexpr double kError = 0.05;
  constexpr double kWidth = 0.07;
  const double order = 1 / (1 + std::exp((keys[0] - transitionAt(keys[1])) / kWidth));
  RunResult result;
  result.identity = data.rows[row].identity;
  result.columns = {{"order", order + kError * random.normal()}, {"order.standard_error", kError}};
  data.survey.rows[row] = {RowState::Kind::kDone, std::move(result), {}};
}

}  // namespace lab::runner::campaign::adaptive_samples
