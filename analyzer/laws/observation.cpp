#include "analyzer/laws/observation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analyzer/laws/chebyshev.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

// Largest product of an integration step and Law::variationRate(), [1]. Over such a step the
// 20-point Gauss rule is exact up to rounding.
constexpr double kStepVariation = 6;

/// Limits of the integration intervals, ascending: every w at which M(tau + w), M(|tau - w|) or
/// M(w) may have a kink (M is the MSD or the angular MSD), and further points so that no interval
/// is too long for the Gauss rule.
/// @param law must exist, so that kinkSpacing() > 0
std::vector<double> integrationLimits(const Law& law, double tau, double exposure) {
  const double kink = law.kinkSpacing();
  const double remainder = std::fmod(tau, kink);
  std::vector<double> ends{0, exposure};
  const auto add = [&](double w) {
    if (w > 0 && w < exposure) ends.push_back(w);
  };
  add(tau);
  for (double k = 0; kink > 0 && k * kink <= exposure + kink; ++k) {
    add(k * kink);
    add(k * kink + remainder);
    add((k + 1) * kink - remainder);
  }
  const double step = kStepVariation / std::max(law.variationRate(), kStepVariation / exposure);
  for (double w = step; w < exposure; w += step) add(w);
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// The integral in the comment of observedMsd(): the MSD of poses that are means over the exposure.
template <typename Msd>
double blurred(const ExactLaw& law, double tau, double exposure, const Msd& msd) {
  if (!law.exists()) return units::kNan;
  if (!(exposure > 0)) return msd(tau);
  static const GaussRule rule = gaussLegendre(20);
  const std::vector<double> ends = integrationLimits(*law.program(), tau, exposure);
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

double observedMsd(const ExactLaw& law, const MeasurementModel& model, double tau) {
  return blurred(law, tau, model.exposure, [&law](double t) { return law.msd(t); }) +
         4 * model.sigma * model.sigma;
}

double observedAngularMsd(const ExactLaw& law, const MeasurementModel& model, double tau) {
  return blurred(law, tau, model.exposure, [&law](double t) { return law.angularMsd(t); }) +
         2 * model.sigma_theta * model.sigma_theta;
}

}  // namespace lab::analysis
