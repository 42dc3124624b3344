#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "runner/campaign/adaptive/goal_state.hpp"
#include "runner/campaign/adaptive/noise_model.hpp"

namespace lab::runner::campaign {
namespace {

constexpr double kLogarithmicRatio = 5;
constexpr double kTypicalError = 0.1;   // of a run, before anything is measured
constexpr double kScatterFreedom = 10;  // of the prior that scatter and stated errors agree

std::vector<KeyScale> scalesOf(const std::vector<Candidate>& candidates) {
  std::vector<KeyScale> scales;
  for (std::size_t k = 0; k < candidates.front().keys.size(); ++k) {
    KeyScale scale{candidates.front().keys[k], candidates.front().keys[k]};
    for (const Candidate& candidate : candidates) {
      scale.low = std::min(scale.low, candidate.keys[k]);
      scale.high = std::max(scale.high, candidate.keys[k]);
    }
    scale.logarithmic = scale.low > 0 && scale.high >= kLogarithmicRatio * scale.low;
    scales.push_back(scale);
  }
  return scales;
}

Eigen::MatrixXd scaledKeys(const std::vector<Candidate>& candidates,
                           const std::vector<KeyScale>& scales) {
  Eigen::MatrixXd inputs(static_cast<Eigen::Index>(candidates.size()),
                         static_cast<Eigen::Index>(scales.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t k = 0; k < scales.size(); ++k) {
      inputs(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          scales[k].scaled(candidates[i].keys[k]);
    }
  }
  return inputs;
}

/// Sum of squares about the means in units of the noise, over its degrees of freedom; at least 1.
double excessScatter(const std::map<std::size_t, std::vector<double>>& values,
                     const Eigen::VectorXd& noise, ErrorScale scale) {
  double squares = kScatterFreedom;
  double freedom = kScatterFreedom;
  for (const auto& [candidate, all] : values) {
    const Eigen::Map<const Eigen::ArrayXd> runs(all.data(), static_cast<Eigen::Index>(all.size()));
    const double mean = runs.mean();
    const double unit = scale == ErrorScale::kRelative ? mean * mean : 1;
    const double sum =
        (runs - mean).square().sum() / (unit * noise(static_cast<Eigen::Index>(candidate)));
    if (all.size() < 2 || !std::isfinite(sum)) continue;
    squares += sum;
    freedom += static_cast<double>(all.size() - 1);
  }
  return std::max(1.0, squares / freedom);
}

}  // namespace

double KeyScale::scaled(double value) const {
  if (!(high > low)) return 0.5;
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

double KeyScale::value(double scaled) const {
  return logarithmic ? low * std::pow(high / low, scaled) : low + scaled * (high - low);
}

Measurements measurementsOf(const std::vector<Candidate>& candidates,
                            const std::vector<RunValue>& runs, ErrorScale scale) {
  Measurements all;
  all.scales = scalesOf(candidates);
  all.inputs = scaledKeys(candidates, all.scales);
  std::vector<StatedError> stated;
  std::map<std::size_t, std::vector<double>> values;
  double typical = 0;
  for (const RunValue& run : runs) {
    const double unit = scale == ErrorScale::kRelative ? run.value : 1;
    const double variance = run.sigma * run.sigma / (unit * unit);
    values[run.candidate].push_back(run.value);
    if (!(variance > 0) || !std::isfinite(variance)) continue;
    const double duration = candidates[run.candidate].duration;
    typical += variance * duration;
    stated.push_back({all.inputs.row(static_cast<Eigen::Index>(run.candidate)), duration, variance,
                      run.effective_samples});
  }
  typical = stated.empty() ? kTypicalError * kTypicalError * candidates.front().duration
                           : typical / static_cast<double>(stated.size());
  const NoiseModel model(stated, all.inputs.cols(), typical);
  all.noise.resize(all.inputs.rows());
  for (Eigen::Index i = 0; i < all.noise.size(); ++i) {
    all.noise(i) =
        model.variance(all.inputs.row(i), candidates[static_cast<std::size_t>(i)].duration);
  }
  all.noise *= excessScatter(values, all.noise, scale);
  for (const auto& [candidate, of_point] : values) {
    const Eigen::Map<const Eigen::ArrayXd> numbers(of_point.data(),
                                                   static_cast<Eigen::Index>(of_point.size()));
    all.points.push_back(
        {candidate, numbers.mean(),
         all.noise(static_cast<Eigen::Index>(candidate)) / static_cast<double>(of_point.size())});
  }
  return all;
}

std::vector<std::size_t> distinctPlaces(const std::vector<Candidate>& candidates) {
  std::set<std::vector<double>> seen;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (seen.insert(candidates[i].keys).second) places.push_back(i);
  }
  return places;
}

}  // namespace lab::runner::campaign
