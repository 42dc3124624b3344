#include "analyzer/fits/law_hypothesis.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "analyzer/curves/block_errors.hpp"
#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/frame_phases.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/fits/distance_distribution.hpp"
#include "analyzer/fits/fit_plan.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

// Least ratio of the observed time to a lag. At longer lags the distribution is too skew.
constexpr double kRecordingsPerLag = 36;
constexpr double kRecordingsPerTrack = 3;  // length of a track, in longest simulated lags
constexpr double kSimulatedLags = 36;      // length of a simulated recording, in its longest lags
constexpr double kLeastEvents = 400;       // smallest number of events in a simulated recording
constexpr double kMostEvents = 5e6;        // largest number of events in all of them
constexpr int kFramesPerHold = 4;
constexpr double kMatch = 0.1;  // largest relative difference between measured and simulated lags
constexpr std::size_t kFewestLags = 4;

bool hasSpeed(const ProgramLaw& law) {
  return !law->speedParameter().empty() && law->meanSpeed() != 0;
}

/// The law of a test at one lag, without noise.
double expected(TestedLaw tested, const ProgramLaw& law, bool angular, double tau) {
  if (tested == TestedLaw::kPaper) return law->paperMsd(tau);
  const ExactLaw exact(law);
  return angular ? exact.angularMsd(tau) : exact.msd(tau);
}

/// One lag of one curve.
struct Column {
  std::size_t simulated = 0;
  std::size_t measured = 0;
  bool angular = false;
};

std::vector<Column> columnsOf(TestedLaw tested, const MeasuredCurves& curves,
                              const SimulatedCurves& simulated, const TestOptions& options) {
  std::vector<Column> columns;
  for (const bool angular : {false, true}) {
    if (angular && tested != TestedLaw::kExact) break;
    for (std::size_t s = 0; s < simulated.lags.size(); ++s) {
      const double tau = simulated.lags[s];
      std::size_t best = 0;
      for (std::size_t i = 1; i < curves.lags.size(); ++i) {
        if (std::abs(curves.lags[i] - tau) < std::abs(curves.lags[best] - tau)) best = i;
      }
      const double value = (angular ? curves.angular_msd : curves.msd)[best];
      const bool selected = options.longest_lag > 0 && curves.lags[best] > options.longest_lag;
      if (std::isfinite(value) && !selected && std::abs(curves.lags[best] - tau) < kMatch * tau &&
          kRecordingsPerLag * tau <= curves.observed) {
        columns.push_back({s, best, angular});
      }
    }
  }
  return columns;
}

/// The standard error of the live estimate of 4 sigma^2, from blocks.
double offsetError(const ProgramLaw& law, const BlockData& data) {
  constexpr double kFrames = 50;  // of a block
  const Estimator estimator(law, data);
  const std::vector<BlockGroup> groups = groupBlocks(data, kFrames * data.frame_period);
  const Replicates replicates = jackknife(
      groups, totalOf(groups, data, estimator.total()), estimator.neededLags(),
      [&](const BlockSums& sums) { return std::vector<double>{estimator(sums)[kPositionOffset]}; });
  return finiteOrZero(replicates.sigma(0));
}

}  // namespace

MeasuredCurves measuredCurves(const ProgramLaw& law, const BlockData& data) {
  MeasuredCurves curves;
  curves.observed = data.observed();
  if (!(curves.observed > 0)) return curves;
  const BlockSums total = data.total();
  const Quantities live = Estimator(law, data)(total);
  curves.frame_period = data.frame_period;
  curves.tracks = static_cast<double>(data.tracks.size());
  curves.segments = std::max(curves.tracks, total.segments);
  curves.offset = finiteOrZero(live[kPositionOffset]);
  curves.angular_offset = finiteOrZero(live[kHeadingOffset]);
  curves.offset_sigma = offsetError(law, data);
  curves.gaps = gapsOf(data, total);
  const double joins = total.joins / total.time * data.frame_period;
  for (std::size_t i = 0; i < data.lags.size(); ++i) {
    const LagSums& lag = total.lags[i];
    curves.lags.push_back(data.lagTime(i, total));
    curves.msd.push_back(lag.windows > 0 ? lag.r2 / lag.windows : kNan);
    const double covered = coveredShare(curves.gaps, data.lags[i], lag, true);
    const bool enough = lag.angular_windows > 0 && covered >= kLeastCovered;
    curves.angular_msd.push_back(enough ? lag.a2 / lag.angular_windows : kNan);
    // The two positions at a join have noise too, which every window across the join contains.
    curves.joined.push_back(1 + joins * std::max(0, data.lags[i] - 2));
  }
  return curves;
}

SimulatedCurves simulateForTest(const ProgramLaw& law, const MeasuredCurves& curves, int recordings,
                                std::uint64_t seed) {
  const double hold = law->changeTime();
  const double track = curves.observed / curves.tracks;
  double longest = std::min(curves.lags.back(), track / kRecordingsPerTrack);
  const auto covered = [&] { return curves.gaps.covered(longest / curves.frame_period); };
  while (covered() < kLeastCovered) longest *= 0.9;
  const auto duration = [&] {
    return std::min(track, std::max(kSimulatedLags * longest / covered(), kLeastEvents * hold));
  };
  const double event = law->drawTime() / law->changesPerDraw();
  while (recordings * duration() / event > kMostEvents && longest > 8 * hold) longest /= 2;
  BootstrapPlan plan;
  plan.law = law;
  plan.sigma = std::sqrt(std::max(0.0, curves.offset / 4));
  plan.sigma_theta = std::sqrt(std::max(0.0, curves.angular_offset / 2));
  // Whole frames: with more windows than the measured recording the noise would be too small.
  plan.period = std::max(1.0, std::floor(hold / kFramesPerHold / curves.frame_period)) *
                curves.frame_period * kDrift;
  plan.frame_period = curves.frame_period;
  plan.gaps = curves.gaps;
  plan.duration = duration();
  plan.recordings = recordings;
  plan.seed = seed;
  for (double octave = hold / 2; octave <= 1.1 * longest; octave *= 2) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < curves.lags.size(); ++i) {
      if (std::abs(curves.lags[i] - octave) < std::abs(curves.lags[best] - octave)) best = i;
    }
    const double lag = curves.lags[best];
    if (lag > longest || lag < 0.5 * plan.period) continue;
    const bool apart = plan.lags.empty() || lag > 1.4 * plan.lags.back();
    if (std::abs(lag - octave) < 0.3 * octave && apart) {
      plan.lags.push_back(lag);
      plan.angular.push_back(std::isfinite(curves.angular_msd[best]));
    }
  }
  if (plan.lags.empty()) return {};
  return simulateCurves(plan);
}

namespace {

/// The deviation of the curves from a law with the covariance of its recordings.
class Distance {
 public:
  Distance(TestedLaw tested, const ProgramLaw& law, const MeasuredCurves& curves,
           const SimulatedCurves& simulated, const TestOptions& options,
           std::vector<Column> columns)
      : tested_(tested),
        law_(law),
        curves_(curves),
        options_(options),
        columns_(std::move(columns)),
        n_(static_cast<Eigen::Index>(columns_.size())) {
    setScatter(simulated);
    scatter_ += offset_share_ * offset_share_.transpose();
    covariance_ = scatter_;
    addPhases();
    covariance_.diagonal().array() += options_.systematic_floor * options_.systematic_floor;
    factor_.compute(covariance_);
  }

  [[nodiscard]] bool isRegular() const { return factor_.info() == Eigen::Success; }

  /// Sets the distance, with the speed that fits best if it is free.
  void test(LawTest& result) const {
    Eigen::MatrixXd nuisance = headingOffset();
    Eigen::VectorXd off = deviation(1);
    if (hasSpeed(law_)) {
      const double speed = bestSpeed(nuisance);
      if (std::abs(speed - 1) <= options_.speed_tolerance) {
        result.speed = speed;
        off = deviation(speed);
        nuisance.conservativeResize(Eigen::NoChange, nuisance.cols() + 1);
        nuisance.rightCols(1) = slope(speed);
      }
    }
    result.freedom = static_cast<int>(n_ - nuisance.cols());
    const Eigen::MatrixXd weights = factor_.solve(Eigen::MatrixXd::Identity(n_, n_));
    const DistanceDistribution distribution(scatter_, weights, nuisance, recordings_, rare_);
    result.distance2 = distribution.distance2(off);
    result.p_value = distribution.tail(result.distance2);
    result.deviate = deviateOf(result.p_value);
  }

 private:
  [[nodiscard]] const Column& at(Eigen::Index j) const {
    return columns_[static_cast<std::size_t>(j)];
  }
  [[nodiscard]] double lag(const Column& c) const { return curves_.lags[c.measured]; }
  [[nodiscard]] double offsetOf(const Column& c) const {
    return c.angular ? curves_.angular_offset : curves_.offset * curves_.joined[c.measured];
  }
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& of) const {
    if (of.cols() == 0) return of;  // Eigen takes the address of its first element
    return factor_.matrixL().solve(of);
  }

  /// The component orthogonal to the directions.
  static Eigen::VectorXd without(const Eigen::MatrixXd& directions, const Eigen::VectorXd& of) {
    if (directions.cols() == 0) return of;
    const Eigen::MatrixXd unit =
        directions * directions.colwise().norm().cwiseInverse().asDiagonal();
    return of - unit * (unit.transpose() * unit).ldlt().solve(unit.transpose() * of);
  }

  /// The direction of an error of the heading's noise, a constant added to the angular MSD. It is
  /// free, because its live estimate is made of the same angular MSD.
  [[nodiscard]] Eigen::MatrixXd headingOffset() const {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const Column& c = at(j);
      if (c.angular) direction(j) = 1 / expected(tested_, law_, true, lag(c));
    }
    return direction.norm() > 0 ? Eigen::MatrixXd(direction) : Eigen::MatrixXd(n_, 0);
  }

  void setScatter(const SimulatedCurves& simulated) {
    const ExactLaw exact(law_);
    const std::size_t width = simulated.lags.size();
    recordings_ = simulated.recordings;
    Eigen::MatrixXd values(recordings_, n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const Column& c = at(j);
      const std::size_t column = (c.angular ? width : 0) + c.simulated;
      const double tau = simulated.lags[c.simulated];
      const double truth = c.angular ? exact.angularMsd(tau) : exact.msd(tau);
      const double simulated_offset = simulated.law[column] - truth;
      const double scale = errorScale(simulated, curves_.observed, curves_.segments, tau);
      for (int recording = 0; recording < recordings_; ++recording) {
        // Scaled to the errors of the measured time before the cube root is taken, because the
        // bias of the cube root depends on the size of the errors.
        const double ratio = (simulated.value(recording, column) - simulated_offset) / truth;
        values(recording, j) = normalised(1 + scale * (ratio - 1));
      }
    }
    offset_share_ = Eigen::VectorXd::Zero(n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const Column& c = at(j);
      if (c.angular) continue;
      offset_share_(j) = curves_.offset_sigma * curves_.joined[c.measured] /
                         expected(tested_, law_, false, lag(c));
    }
    mean_ = values.colwise().mean().transpose();
    values.rowwise() -= mean_.transpose();
    scatter_ = values.transpose() * values / (recordings_ - 1);
  }

  /// Adds what frames do that keep their phases of the hold.
  void addPhases() {
    const FramePhases phases(law_, curves_.frame_period, curves_.observed, curves_.tracks);
    if (!phases.matter()) return;
    Eigen::MatrixXd deviations(FramePhases::kPhases, n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const double frames = std::round(lag(at(j)) / curves_.frame_period);
      const FramePhases::Deviations of = phases.of(at(j).angular, frames);
      deviations.col(j) = Eigen::Map<const Eigen::VectorXd>(of.data(), FramePhases::kPhases) /
                          expected(tested_, law_, at(j).angular, lag(at(j)));
    }
    const Eigen::MatrixXd covariance = deviations.transpose() * deviations / FramePhases::kPhases;
    scatter_ += phases.usual() * covariance;
    rare_ = FramePhases::kUnlucky;
    covariance_ += covariance;
  }
  /// From the law with `speed` times the programmed speed.
  [[nodiscard]] Eigen::VectorXd deviation(double speed) const {
    const ProgramLaw law = speed == 1 ? law_ : law_.withSpeed(speed * law_->meanSpeed());
    Eigen::VectorXd result(n_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const Column& c = at(j);
      const double value = (c.angular ? curves_.angular_msd : curves_.msd)[c.measured];
      result(j) =
          normalised((value - offsetOf(c)) / expected(tested_, law, c.angular, lag(c))) - mean_(j);
    }
    return result;
  }

  /// The change of the law, relative to the deviation, with the relative speed.
  [[nodiscard]] Eigen::VectorXd slope(double speed) const {
    constexpr double kStep = 1e-4;
    return (deviation(speed - kStep) - deviation(speed + kStep)) / (2 * kStep);
  }

  [[nodiscard]] double bestSpeed(const Eigen::MatrixXd& nuisance) const {
    constexpr int kSteps = 8;
    constexpr double kFurthest = 0.5;
    const Eigen::MatrixXd others = whitened(nuisance);
    double speed = 1;
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::VectorXd direction = without(others, whitened(slope(speed)));
      const double length2 = direction.squaredNorm();
      if (!(length2 > 0)) return units::kNan;
      const double step = direction.dot(whitened(deviation(speed)).col(0)) / length2;
      speed += step;
      if (!(std::abs(speed - 1) < kFurthest)) return speed;
      if (std::abs(step) < 1e-7) break;
    }
    return speed;
  }

  TestedLaw tested_;
  const ProgramLaw& law_;
  const MeasuredCurves& curves_;
  const TestOptions& options_;
  std::vector<Column> columns_;
  Eigen::Index n_;
  int recordings_ = 0;
  Eigen::VectorXd mean_;          ///< Of the simulated recordings.
  Eigen::VectorXd offset_share_;  ///< By the error of the noise of the positions.
  Eigen::MatrixXd scatter_;       ///< Covariance of both, and of the usual phases of the frames.
  double rare_ = 0;               ///< Share of recordings whose frames keep step with the holds.
  Eigen::MatrixXd covariance_;    ///< The same with rare phases and the systematic floor.
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace

LawTest testLaw(TestedLaw tested, const ProgramLaw& law, const MeasuredCurves& curves,
                const SimulatedCurves& simulated, const TestOptions& options) {
  LawTest result;
  result.p_value = result.deviate = kNan;
  result.speed = 1;
  const std::vector<Column> columns = columnsOf(tested, curves, simulated, options);
  if (columns.size() < kFewestLags || simulated.recordings < 4 * static_cast<int>(columns.size())) {
    return result;
  }
  for (const Column& c : columns) {
    if (!c.angular) result.lags.push_back(curves.lags[c.measured]);
  }
  const Distance distance(tested, law, curves, simulated, options, columns);
  if (distance.isRegular()) distance.test(result);
  return result;
}

}  // namespace lab::analysis
