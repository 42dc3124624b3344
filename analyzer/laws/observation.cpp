#include "analyzer/laws/observation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "analyzer/laws/chebyshev.hpp"

namespace lab::analysis {
namespace {

constexpr double kSmoothTurn =
    6;  // rad of turning over which the 20-point Gauss rule is exact to rounding

/// The laws are smooth between multiples of this time, s.
double kinkEvery(const ProgramLaw& law) {
  return law.kind == ProgramKind::kRtp ? law.tau_t : law.epsilon;
}

/// The largest turning rate, rad/s.
double fastestTurn(const ProgramLaw& law) {
  switch (law.kind) {
    case ProgramKind::kAbp:
      return law.eta;
    case ProgramKind::kNoisyAbp:
    case ProgramKind::kBp:
      return 2 * law.V / law.wheel_base;
    case ProgramKind::kRtp:
      return law.gamma + 2 * std::numbers::pi / law.tau_t;
    case ProgramKind::kNone:
    case ProgramKind::kWheels:
      break;
  }
  return 0;
}

/// Integration limits: where M(tau + w), M(|tau - w|) or M(w) may have a kink, and steps between.
std::vector<double> pieces(const ProgramLaw& law, double tau, double exposure) {
  const double kink = kinkEvery(law);
  const double back = std::fmod(tau, kink);
  std::vector<double> ends{0, exposure};
  const auto add = [&](double w) {
    if (w > 0 && w < exposure) ends.push_back(w);
  };
  add(tau);
  for (double k = 0; k * kink <= exposure + kink; ++k) {
    add(k * kink);
    add(k * kink + back);
    add((k + 1) * kink - back);
  }
  const double step = kSmoothTurn / std::max(fastestTurn(law), kSmoothTurn / exposure);
  for (double w = step; w < exposure; w += step) add(w);
  std::sort(ends.begin(), ends.end());
  return ends;
}

template <typename Msd>
double smeared(const ProgramLaw& law, double tau, double exposure, const Msd& msd) {
  if (!(exposure > 0)) return msd(tau);
  static const GaussRule rule = gaussLegendre(20);
  const std::vector<double> ends = pieces(law, tau, exposure);
  double sum = 0;
  for (std::size_t p = 1; p < ends.size(); ++p) {
    const double length = ends[p] - ends[p - 1];
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double w = ends[p - 1] + length * rule.nodes[i];
      sum += length * rule.weights[i] * (exposure - w) *
             (msd(tau + w) + msd(std::abs(tau - w)) - 2 * msd(w));
    }
  }
  return sum / (exposure * exposure);
}

}  // namespace

double observedMsd(const ExactLaw& law, const Observation& observation, double tau) {
  return smeared(law.program(), tau, observation.exposure,
                 [&law](double t) { return law.msd(t); }) +
         4 * observation.sigma * observation.sigma;
}

double observedAngularMsd(const ExactLaw& law, const Observation& observation, double tau) {
  return smeared(law.program(), tau, observation.exposure,
                 [&law](double t) { return law.angularMsd(t); }) +
         2 * observation.sigma_theta * observation.sigma_theta;
}

}  // namespace lab::analysis
