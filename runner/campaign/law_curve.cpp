#include "runner/campaign/law_curve.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "runner/campaign/campaign_laws.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kCurvePieces = 100;
constexpr double kLeastProbability = 0.01;

}  // namespace

std::optional<DrawnLaw> drawnLaw(const CampaignData& data, const PooledTable& pooled,
                                 std::size_t quantity) {
  const auto law = powerLawOf(data, pooled, quantity);
  if (!law) return {};
  if (law->exact) return DrawnLaw{*law->exact, law->axes, true};
  const bool has_theory = std::ranges::any_of(pooled.points, [&](const PooledPoint& point) {
    return std::isfinite(point.theory[quantity]);
  });
  if (has_theory || !(law->measured.p >= kLeastProbability)) return {};
  return DrawnLaw{law->measured, law->axes, false};
}

std::vector<std::pair<double, double>> lawCurve(const DrawnLaw& law, std::size_t x,
                                                const PointValues& values, double low, double high,
                                                bool logarithmic) {
  std::vector<std::pair<double, double>> curve;
  if (!(low < high)) return curve;
  for (int i = 0; i <= kCurvePieces; ++i) {
    const double share = static_cast<double>(i) / kCurvePieces;
    const double key = logarithmic ? low * std::pow(high / low, share) : low + share * (high - low);
    double value = law.law.prefactor.value;
    for (std::size_t k = 0; k < law.axes.size(); ++k) {
      const double one =
          law.axes[k] == x ? key : numberIn(values[law.axes[k]]).value_or(units::kNan);
      value *= std::pow(one, law.law.exponents[k].value);
    }
    curve.emplace_back(key, value);
  }
  return curve;
}

}  // namespace lab::runner::campaign
