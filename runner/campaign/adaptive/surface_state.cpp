#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "runner/campaign/adaptive/gaussian_process.hpp"
#include "runner/campaign/adaptive/goal_state.hpp"

namespace lab::runner::campaign {
namespace {

Measured measuredOf(const Measurements& measurements, bool relative) {
  std::vector<MeasuredPoint> points = measurements.points;
  // The logarithm of a value that is not positive does not exist.
  if (relative) std::erase_if(points, [](const MeasuredPoint& point) { return !(point.mean > 0); });
  const auto count = static_cast<Eigen::Index>(points.size());
  Measured measured{Inputs(count, measurements.inputs.cols()), Eigen::VectorXd(count),
                    Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const MeasuredPoint& point = points[static_cast<std::size_t>(i)];
    measured.inputs.row(i) = measurements.inputs.row(static_cast<Eigen::Index>(point.candidate));
    measured.means(i) = relative ? std::log(point.mean) : point.mean;
    measured.noise(i) = point.variance;
  }
  return measured;
}

}  // namespace

GoalState surfaceState(const AdaptivePlan& plan, const std::vector<Candidate>& candidates,
                       const std::vector<RunValue>& runs) {
  const Measurements measurements = measurementsOf(
      candidates, runs, plan.relative ? ErrorScale::kRelative : ErrorScale::kAbsolute);
  const Measured measured = measuredOf(measurements, plan.relative);
  const GaussianProcess process = GaussianProcess::fitted(measured);
  const std::vector<std::size_t> places = distinctPlaces(candidates);
  const auto count = static_cast<Eigen::Index>(places.size());
  Inputs targets(count, measurements.inputs.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    targets.row(i) =
        measurements.inputs.row(static_cast<Eigen::Index>(places[static_cast<std::size_t>(i)]));
  }

  GoalState state;
  GaussianDesign& design = state.design;
  design.weights = Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count));
  design.variances = process.posterior(targets, targets).diagonal().cwiseMax(0);
  design.cross = process.posterior(targets, measurements.inputs);
  design.candidates = process.posterior(measurements.inputs, measurements.inputs);
  design.noise = measurements.noise;
  if (measured.means.size() == 0) return state;

  const Eigen::VectorXd mean = process.mean(targets);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double sigma = std::sqrt(design.variances(i));
    const double value = plan.relative ? std::exp(mean(i)) : mean(i);
    state.surface.push_back(
        {places[static_cast<std::size_t>(i)], value, plan.relative ? sigma * value : sigma});
  }
  // A plane has a parameter more than there are keys.
  if (measured.means.size() > measurements.inputs.cols() + 1) {
    state.error = std::sqrt(design.variance());
  }
  return state;
}

}  // namespace lab::runner::campaign
