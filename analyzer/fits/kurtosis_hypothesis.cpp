#include "analyzer/fits/kurtosis_hypothesis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "analyzer/bootstrap/kurtosis_bootstrap.hpp"
#include "analyzer/curves/estimates.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kShare = 1.0 / 40;  // longest lag, as a share of the recording
constexpr int kFirstHolds = 2;       // shortest lag, in holds
constexpr int kIsotropicHolds = 10;  // at shorter lags even isotropic draws are not Gaussian
constexpr double kIsotropic = 2;
constexpr double kRejects = 0.01;
constexpr double kSmallestP = 1e-12;  // the tails are not known beyond this
constexpr double kLongestRecording =
    4096;  // s, of simulated recordings; for longer ones, errors are scaled
constexpr double kLengthsPerOctave =
    2;  // of simulated recordings, so that robots of one run share them

/// Contribution of the tracker noise to the MSD, m^2; 0 if it cannot be determined.
double noiseOffset(const ProgramLaw& law, const BlockData& data) {
  const double offset = Estimator(law, data)(data.total())[kPositionOffset];
  return offset > 0 ? offset : 0;
}

double recordingLength(double observed) {
  const double octave = std::round(std::log2(observed) * kLengthsPerOctave) / kLengthsPerOctave;
  return std::min(kLongestRecording, std::exp2(octave));
}

/// Computes the deviation of every lag, and the probability of the largest one under the
/// hypothesis.
/// @param from the first lag that is tested
KurtosisAnswer testHypothesis(const ProgramLaw& law, KurtosisHypothesis hypothesis, double observed,
                              const std::vector<int>& holds, std::size_t from,
                              const DisplacementKurtosis& exact, std::vector<KurtosisPoint>& lags) {
  KurtosisAnswer answer;
  answer.p = kNan;
  if (from >= lags.size()) return answer;
  const bool own = hypothesis == KurtosisHypothesis::kProgram;
  const std::vector<int> tested(holds.begin() + static_cast<std::ptrdiff_t>(from), holds.end());
  const double length = recordingLength(observed);
  const KurtosisBootstrap& recordings = kurtosisBootstrap(law, hypothesis, tested, length);
  double largest = 0;
  for (std::size_t i = from; i < lags.size(); ++i) {
    KurtosisPoint& lag = lags[i];
    // Bias of a recording of this length: the bias of the simulated ones, scaled by 1/T.
    const double of_recordings =
        own ? exact.kurtosis(tested[i - from] * recordings.period) : kIsotropic;
    const double bias = (recordings.mean[i - from] - of_recordings) * length / observed;
    const double sigma = recordings.sigma[i - from] * std::sqrt(length / observed);
    const double z = (lag.kurtosis - (own ? lag.exact : kIsotropic) - bias) / sigma;
    if (own) lag.sigma = sigma;
    (own ? lag.z_exact : lag.z_isotropic) = z;
    if (std::abs(z) <= largest) continue;
    largest = std::abs(z);
    answer.tau = lag.tau;
  }
  const auto count = static_cast<double>(recordings.largest.size());
  const auto above = static_cast<double>(
      recordings.largest.end() -
      std::lower_bound(recordings.largest.begin(), recordings.largest.end(), largest));
  answer.p = (above + 1) / (count + 1);
  if (above == 0) {
    // Larger than in all simulations: bounded by independent normal lags.
    const double tail = static_cast<double>(tested.size()) * std::erfc(largest / std::sqrt(2.0));
    answer.p = std::max(kSmallestP, std::min(answer.p, tail));
  }
  answer.rejected = answer.p < kRejects;
  return answer;
}

__attribute__((format(printf, 1, 2))) std::string words(const char* format, ...) {
  std::array<char, 256> text{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  return text.data();
}

std::string pText(double p) {
  return p <= kSmallestP ? words("p < %.0e", kSmallestP) : words("p = %.2g", p);
}

std::string verdict(const KurtosisTest& test) {
  const auto at = [&test](const KurtosisAnswer& answer) {
    return *std::ranges::find(test.lags, answer.tau, &KurtosisPoint::tau);
  };
  std::string text = "Too short to be distinguished from Brownian motion in the plane. ";
  if (std::isfinite(test.isotropic.p)) {
    const KurtosisPoint lag = at(test.isotropic);
    text = test.isotropic.rejected ? "Not Brownian motion in the plane"
                                   : "Not distinguishable from Brownian motion in the plane";
    text += words(": kurtosis %.2f at %.3g s, 2 expected (%s). ", lag.kurtosis, lag.tau,
                  pText(test.isotropic.p).c_str());
  }
  const KurtosisPoint lag = at(test.exact);
  text += test.exact.rejected
              ? "It is not the programmed diffusion along the robot's own axis"
              : "It agrees with the programmed diffusion along the robot's own axis";
  text += words(": farthest off at %.3g s with %.2f, %.2f +- %.2f expected (%s).", lag.tau,
                lag.kurtosis, lag.exact, lag.sigma, pText(test.exact.p).c_str());
  return text;
}

}  // namespace

std::optional<KurtosisTest> testKurtosis(const ProgramLaw& law, const BlockData& data) {
  const auto wheels = law->drawnWheels();
  if (!wheels || !(wheels->half_width > 0)) return std::nullopt;
  const auto exact = law->kurtosis();
  const double observed = exact ? data.observed() : 0;
  if (!(observed > 0)) return std::nullopt;
  const double offset = noiseOffset(law, data);
  const BlockSums total = data.total();
  // Pools may be longer than the simulated recordings.
  const double longest = kShare * std::min(observed, recordingLength(observed));
  KurtosisTest test;
  std::vector<int> holds;
  std::size_t isotropic_from = 0;
  for (std::size_t i = 0; i < data.lags.size(); ++i) {
    const LagSums& sums = total.lags[i];
    const double tau = data.lagTime(i, total);
    const int whole = static_cast<int>(std::lround(tau / law->drawTime()));
    if (whole < (holds.empty() ? kFirstHolds : 2 * holds.back())) continue;
    if (tau > longest || sums.windows == 0 || !(sums.r2 > 0)) break;
    KurtosisPoint lag;
    lag.tau = tau;
    lag.kurtosis = sums.r4 * sums.windows / (sums.r2 * sums.r2);
    lag.exact = exact->observed(tau, offset);
    lag.z_isotropic = kNan;
    if (whole < kIsotropicHolds) ++isotropic_from;
    holds.push_back(whole);
    test.lags.push_back(lag);
  }
  if (test.lags.empty()) return std::nullopt;
  test.exact =
      testHypothesis(law, KurtosisHypothesis::kProgram, observed, holds, 0, *exact, test.lags);
  test.isotropic = testHypothesis(law, KurtosisHypothesis::kIsotropic, observed, holds,
                                  isotropic_from, *exact, test.lags);
  test.text = verdict(test);
  return test;
}

}  // namespace lab::analysis
