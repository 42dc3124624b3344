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

Eigen::MatrixXd scaledKeys(const std::vector<Candidate>& candidates) {
  const auto rows = static_cast<Eigen::Index>(candidates.size());
  const auto keys = static_cast<Eigen::Index>(candidates.front().keys.size());
  Eigen::MatrixXd inputs(rows, keys);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 0; k < keys; ++k) {
      inputs(i, k) = candidates[static_cast<std::size_t>(i)].keys[static_cast<std::size_t>(k)];
    }
  }
  for (Eigen::Index k = 0; k < keys; ++k) {
    auto column = inputs.col(k);
    if (column.minCoeff() > 0 && column.maxCoeff() >= kLogarithmicRatio * column.minCoeff()) {
      column = column.array().log().matrix().eval();
    }
    const double low = column.minCoeff();
    const double range = column.maxCoeff() - low;
    column = range > 0 ? ((column.array() - low) / range).matrix().eval()
                       : Eigen::VectorXd::Constant(rows, 0.5);
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

Measurements measurementsOf(const std::vector<Candidate>& candidates,
                            const std::vector<RunValue>& runs, ErrorScale scale) {
  Measurements all{scaledKeys(candidates), {}, {}};
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
