#include "analyzer/curves/draw_shape.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analyzer/curves/frame_phases.hpp"
#include "analyzer/curves/lags.hpp"
#include "analyzer/curves/statistics.hpp"

namespace lab::analysis {
namespace {

constexpr double kFewestFrames = 4;  // of a hold
constexpr double kShare = 0.5;       // of a hold, the lag; at least 0.3, at most 0.7
constexpr double kShareRange = 0.2;
constexpr double kHoldsPerBlock = 5;
constexpr std::size_t kFewestBlocks = 8;

/// The kurtosis of the draws from that of rotations in the share `u` of a hold. Of the windows, 1 -
/// u see one draw, and u see two in parts that are uniform.
double ofDraws(double kurtosis, double u) {
  const double shape = 1 - u / 3;
  return (kurtosis * shape * shape - 0.2 * u) / (1 - 0.6 * u);
}

}  // namespace

std::optional<DrawShape> drawShape(const Estimator& estimator, const BlockData& data) {
  const ProgramLaw& law = estimator.law();
  const std::optional<HeldDraws> held = law->held();
  if (!held || !(held->hold >= kFewestFrames * data.frame_period)) return std::nullopt;
  const BlockSums& total = estimator.total();
  const auto tracks = static_cast<double>(data.tracks.size());
  if (FramePhases(law, data.frame_period, total.time, tracks).matter()) return std::nullopt;
  const std::size_t lag = nearestLag(data.lags, kShare * held->hold / data.frame_period);
  const double share = data.lagTime(lag, total) / held->hold;
  const double noise = std::max(0.0, estimator.noise(total).heading_offset);
  if (!(std::abs(share - kShare) <= kShareRange) || !std::isfinite(noise)) return std::nullopt;

  const auto kurtosis = [&](const BlockSums& sums) {
    const LagSums& windows = sums.lags[lag];
    const double square = windows.a2 / windows.angular_windows - noise;
    const double fourth = windows.a4 / windows.angular_windows - 6 * square * noise -
                          3 * noise * noise;  // of normal noise
    return std::vector<double>{ofDraws(fourth / (square * square), share)};
  };
  const LagSums& all = total.lags[lag];
  if (all.angular_windows == 0 || all.a2 / all.angular_windows < 2 * noise) return std::nullopt;
  const std::vector<BlockGroup> groups = groupBlocks(data, kHoldsPerBlock * held->hold);
  if (groups.size() < kFewestBlocks) return std::nullopt;
  const Replicates replicates = jackknife(groups, totalOf(groups, data, total), {lag}, kurtosis);
  DrawShape shape;
  shape.kurtosis = replicates.values.front();
  shape.sigma = replicates.sigma(0);
  shape.programmed = 1 + held->spread;
  shape.z =
      normalDeviate((shape.kurtosis - shape.programmed) / std::hypot(shape.sigma, kShapeTolerance),
                    replicates.degreesOfFreedom());
  if (!std::isfinite(shape.z)) return std::nullopt;
  return shape;
}

}  // namespace lab::analysis
