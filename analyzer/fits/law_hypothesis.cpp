#include "analyzer/fits/law_hypothesis.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/fits/fit_plan.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

// Least ratio of the observed time to a lag. At longer lags the distribution is too skew.
constexpr double kRecordingsPerLag = 36;
constexpr double kRecordingsPerTrack = 3;  // length of a track, in longest simulated lags
constexpr double kSimulatedLags = 12;      // length of a simulated recording, in its longest lags
constexpr double kLeastEvents = 400;       // smallest number of events in a simulated recording
constexpr double kMostEvents = 5e6;        // largest number of events in all of them
constexpr int kFramesPerHold = 4;
constexpr double kOffsetError = 0.05;  // relative error of the tracker noise by the live estimate
constexpr double kMatch = 0.1;  // largest relative difference between measured and simulated lags
constexpr int kFewestLags = 4;

bool hasSpeed(const ProgramLaw& law) {
  return !law->speedParameter().empty() && law->meanSpeed() != 0;
}

/// The law of a test at one lag, without noise.
double expected(TestedLaw tested, const ProgramLaw& law, bool angular, double tau) {
  if (tested == TestedLaw::kPaper) return law->paperMsd(tau);
  const ExactLaw exact(law);
  return angular ? exact.angularMsd(tau) : exact.msd(tau);
}

/// A mean square has nearly a chi-square distribution, so its cube root has nearly a normal one
/// (Wilson and Hilferty). The factor makes the result nearly ratio - 1 where the ratio is nearly 1.
double normalised(double ratio) { return 3 * (std::cbrt(ratio) - 1); }

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
  curves.gaps = gapsOf(data, total);
  const double joins = total.joins / total.time * data.frame_period;
  for (std::size_t i = 0; i < data.lags.size(); ++i) {
    const LagSums& lag = total.lags[i];
    curves.lags.push_back(data.lagTime(i, total));
    curves.msd.push_back(lag.windows > 0 ? lag.r2 / lag.windows : kNan);
    curves.angular_msd.push_back(lag.angular_windows > 0 ? lag.a2 / lag.angular_windows : kNan);
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
  plan.period = hold / kFramesPerHold * kDrift;
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
    if (std::abs(lag - octave) < 0.3 * octave && apart) plan.lags.push_back(lag);
  }
  if (plan.lags.empty()) return {};
  return simulateCurves(plan);
}

LawTest testLaw(TestedLaw tested, const ProgramLaw& law, const MeasuredCurves& curves,
                const SimulatedCurves& simulated, const TestOptions& options) {
  LawTest result;
  result.p_value = result.deviate = kNan;
  result.speed = 1;
  const std::vector<Column> columns = columnsOf(tested, curves, simulated, options);
  const auto n = static_cast<Eigen::Index>(columns.size());
  const std::size_t width = simulated.lags.size();
  if (n < kFewestLags || simulated.recordings < 4 * n) return result;

  const ExactLaw exact(law);
  const ProgramLaw faster = law.withSpeed(law->meanSpeed() * 1.0005);
  Eigen::VectorXd deviation(n);
  Eigen::VectorXd speed_share(n);
  Eigen::VectorXd offset_share(n);
  Eigen::MatrixXd recordings(simulated.recordings, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Column& c = columns[static_cast<std::size_t>(j)];
    const double tau = curves.lags[c.measured];
    if (!c.angular) result.lags.push_back(tau);
    const double offset =
        c.angular ? curves.angular_offset : curves.offset * curves.joined[c.measured];
    const double value = (c.angular ? curves.angular_msd : curves.msd)[c.measured];
    const double reference = expected(tested, law, c.angular, tau);
    deviation(j) = normalised((value - offset) / reference);
    offset_share(j) = kOffsetError * offset / reference;
    speed_share(j) = 1e3 * (expected(tested, faster, c.angular, tau) / reference - 1);
    const std::size_t column = (c.angular ? width : 0) + c.simulated;
    const double lag = simulated.lags[c.simulated];
    const double truth = c.angular ? exact.angularMsd(lag) : exact.msd(lag);
    const double simulated_offset = simulated.law[column] - truth;
    const double scale = errorScale(simulated, curves.observed, curves.segments, lag);
    for (int recording = 0; recording < simulated.recordings; ++recording) {
      // Scaled to the errors of the measured time before the cube root is taken, because the bias
      // of the cube root depends on the size of the errors.
      const double ratio = (simulated.value(recording, column) - simulated_offset) / truth;
      recordings(recording, j) = normalised(1 + scale * (ratio - 1));
    }
  }
  const Eigen::RowVectorXd mean = recordings.colwise().mean();
  recordings.rowwise() -= mean;
  deviation -= mean.transpose();
  Eigen::MatrixXd covariance = recordings.transpose() * recordings / (simulated.recordings - 1);
  covariance.diagonal().array() += options.systematic_floor * options.systematic_floor;
  covariance += offset_share * offset_share.transpose();
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) return result;
  const Eigen::VectorXd white = factor.matrixL().solve(deviation);
  const Eigen::VectorXd direction = factor.matrixL().solve(speed_share);

  result.freedom = static_cast<int>(n);
  result.distance2 = white.squaredNorm();
  if (hasSpeed(law) && direction.squaredNorm() > 0) {
    const double shift = white.dot(direction) / direction.squaredNorm();
    if (std::abs(shift) <= options.speed_tolerance) {
      result.speed = 1 + shift;
      result.distance2 = (white - shift * direction).squaredNorm();
      result.freedom -= 1;
    }
  }
  result.p_value = hotellingTail(result.distance2, result.freedom, simulated.recordings - 1);
  result.deviate = deviateOf(result.p_value);
  return result;
}

}  // namespace lab::analysis
