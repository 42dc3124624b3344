#include "analyzer/curves/turning_rate.hpp"

#include <algorithm>
#include <cmath>

namespace lab::analysis {
namespace {

constexpr double kManyEvents = 100;  // of a lag at which the angular MSD is a straight line

}  // namespace

std::optional<TurningRate> turningRate(const ProgramLaw& law, const BlockSums& total) {
  if (!(total.turn_time > 0) || (!law->held() && !law->runs())) return std::nullopt;
  const double lag = kManyEvents * std::max(law->drawTime(), law->changeTime());
  const double slope = ExactLaw(law).angularMsd(lag) / lag;
  if (!(slope > 0)) return std::nullopt;
  TurningRate rate;
  rate.value = total.turn / total.turn_time;
  rate.sigma = std::sqrt(slope / total.turn_time);
  rate.z = rate.value / rate.sigma;
  return rate;
}

}  // namespace lab::analysis
