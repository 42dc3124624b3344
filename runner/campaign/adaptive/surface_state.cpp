#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "runner/campaign/adaptive/gaussian_process.hpp"
#include "runner/campaign/adaptive/goal_state.hpp"

namespace lab::runner::campaign {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 0.05;  // of the process' sigma
// Places of lines.
constexpr Eigen::Index kShortestLine = 11;
constexpr Eigen::Index kLongestLine = 101;
constexpr Eigen::Index kMostTargets = 2000;

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

/// The design of targets; the weights are those of the mean over them.
GaussianDesign designOf(const GaussianProcess& process, const Measurements& measurements,
                        const Inputs& targets) {
  GaussianDesign design;
  const Eigen::Index count = targets.rows();
  design.weights = Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count));
  design.variances = process.variances(targets);
  design.cross = process.posterior(targets, measurements.inputs);
  design.candidates = process.posterior(measurements.inputs, measurements.inputs);
  design.noise = measurements.noise;
  return design;
}

/// The process, and what it says of all places.
struct Surface {
  GaussianProcess process;
  std::vector<SurfacePoint> points;
  GaussianDesign design;
};

Surface surfaceOf(const Measurements& measurements, const std::vector<Candidate>& candidates,
                  bool relative) {
  const Measured measured = measuredOf(measurements, relative);
  Surface surface{GaussianProcess::fitted(measured), {}, {}};
  const std::vector<std::size_t> places = distinctPlaces(candidates);
  Inputs targets(static_cast<Eigen::Index>(places.size()), measurements.inputs.cols());
  for (Eigen::Index i = 0; i < targets.rows(); ++i) {
    targets.row(i) =
        measurements.inputs.row(static_cast<Eigen::Index>(places[static_cast<std::size_t>(i)]));
  }
  surface.design = designOf(surface.process, measurements, targets);
  if (measured.means.size() == 0) return surface;
  const Eigen::VectorXd mean = surface.process.mean(targets);
  for (Eigen::Index i = 0; i < targets.rows(); ++i) {
    const double sigma = std::sqrt(surface.design.variances(i));
    const double value = relative ? std::exp(mean(i)) : mean(i);
    surface.points.push_back(
        {places[static_cast<std::size_t>(i)], value, relative ? sigma * value : sigma});
  }
  return surface;
}

/// A plane has a parameter more than there are keys.
bool isDetermined(const Measurements& measurements) {
  return static_cast<Eigen::Index>(measurements.points.size()) > measurements.inputs.cols() + 1;
}

/// A line along the first key.
struct Line {
  std::size_t candidate = 0;  ///< the first one that has its other keys
  Inputs places;
};

std::vector<Line> linesOf(const std::vector<Candidate>& candidates,
                          const Measurements& measurements) {
  std::map<std::vector<double>, std::size_t> first;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    first.emplace(std::vector<double>(candidates[i].keys.begin() + 1, candidates[i].keys.end()), i);
  }
  const Eigen::Index length = std::max<Eigen::Index>(
      kShortestLine,
      std::min(kLongestLine, kMostTargets / static_cast<Eigen::Index>(first.size())));
  std::vector<Line> lines;
  for (const auto& [keys, candidate] : first) {
    Line line{candidate,
              measurements.inputs.row(static_cast<Eigen::Index>(candidate)).replicate(length, 1)};
    line.places.col(0) = Eigen::VectorXd::LinSpaced(length, 0, 1);
    lines.push_back(std::move(line));
  }
  return lines;
}

/// The steepest crossing of a line: its position from 0 to 1, and the slope there.
struct SteepestCrossing {
  double position = 0;
  double slope = 0;
  double variance = 0;  ///< of the process there
};

std::optional<SteepestCrossing> crossingOf(const Eigen::VectorXd& mean,
                                           const Eigen::VectorXd& variances, double level) {
  const double step = 1 / static_cast<double>(mean.size() - 1);
  std::optional<SteepestCrossing> steepest;
  for (Eigen::Index i = 0; i + 1 < mean.size(); ++i) {
    const double before = mean(i) - level;
    const double after = mean(i + 1) - level;
    if ((before < 0) == (after < 0)) continue;
    const double slope = std::abs(after - before) / step;
    if (steepest && slope <= steepest->slope) continue;
    const double share = before / (before - after);
    steepest = {(static_cast<double>(i) + share) * step, slope,
                (1 - share) * variances(i) + share * variances(i + 1)};
  }
  return steepest;
}

/// The probability density that the process is at the level, up to a factor: sums to 1.
Eigen::VectorXd levelDensity(const Eigen::VectorXd& mean, const Eigen::VectorXd& variances,
                             double level, double sigma) {
  // On a line of finite steps a density narrower than a step would be missed.
  const double tolerance = kTolerance * sigma;
  const Eigen::ArrayXd spread = (variances.array() + tolerance * tolerance).sqrt();
  const Eigen::ArrayXd squares = ((mean.array() - level) / spread).square();
  const Eigen::VectorXd density = ((-0.5 * (squares - squares.minCoeff())).exp() / spread).matrix();
  return density / density.sum();
}

}  // namespace

GoalState boundaryState(double level, const std::vector<Candidate>& candidates,
                        const std::vector<RunValue>& runs) {
  const Measurements measurements = measurementsOf(candidates, runs, ErrorScale::kAbsolute);
  Surface surface = surfaceOf(measurements, candidates, false);
  GoalState state{std::move(surface.design), kUnknown, std::move(surface.points), {}, {}};
  if (!isDetermined(measurements)) return state;
  const std::vector<Line> lines = linesOf(candidates, measurements);
  const Eigen::Index length = lines.front().places.rows();
  Inputs targets(length * static_cast<Eigen::Index>(lines.size()), measurements.inputs.cols());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    targets.middleRows(static_cast<Eigen::Index>(i) * length, length) = lines[i].places;
  }
  GaussianDesign design = designOf(surface.process, measurements, targets);
  const Eigen::VectorXd mean = surface.process.mean(targets);
  design.weights.setZero();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Eigen::Index begin = static_cast<Eigen::Index>(i) * length;
    const Eigen::VectorXd variances = design.variances.segment(begin, length);
    const auto crossing = crossingOf(mean.segment(begin, length), variances, level);
    if (!crossing) continue;
    design.weights.segment(begin, length) = levelDensity(mean.segment(begin, length), variances,
                                                         level, surface.process.kernel().sigma) /
                                            (crossing->slope * crossing->slope);
    const KeyScale& scale = measurements.scales.front();
    const double sigma = std::sqrt(crossing->variance) / crossing->slope;
    state.crossings.push_back({lines[i].candidate, scale.value(crossing->position),
                               (scale.value(crossing->position + sigma / 2) -
                                scale.value(crossing->position - sigma / 2))});
  }
  if (state.crossings.empty()) return state;
  design.weights /= static_cast<double>(state.crossings.size());
  state.design = std::move(design);
  state.error = std::sqrt(state.design.variance());
  return state;
}

GoalState surfaceState(const AdaptivePlan& plan, const std::vector<Candidate>& candidates,
                       const std::vector<RunValue>& runs) {
  const Measurements measurements = measurementsOf(
      candidates, runs, plan.relative ? ErrorScale::kRelative : ErrorScale::kAbsolute);
  Surface surface = surfaceOf(measurements, candidates, plan.relative);
  GoalState state{std::move(surface.design), kUnknown, std::move(surface.points), {}, {}};
  if (isDetermined(measurements)) state.error = std::sqrt(state.design.variance());
  return state;
}

}  // namespace lab::runner::campaign
