#include "analyzer/collective/whole_motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace lab::collective {
namespace {

constexpr double kLagRatio = 1.35;
constexpr std::size_t kMostFrames = 4000;  // of the longest lag: bounds the memory
// A window of n frames counts if its duration is n periods within half a period.
constexpr double kTolerance = 0.5;

std::vector<std::size_t> lagsUpTo(double longest) {
  std::vector<std::size_t> lags;
  const auto most = std::min(kMostFrames, static_cast<std::size_t>(std::max(1.0, longest)));
  for (double lag = 1; lag <= static_cast<double>(most); lag *= kLagRatio) {
    const auto frames = static_cast<std::size_t>(std::lround(lag));
    if (lags.empty() || frames > lags.back()) lags.push_back(frames);
  }
  return lags;
}

}  // namespace

WholeMotion::WholeMotion(const CrowdSettings& settings)
    : period_(settings.period),
      lags_(lagsUpTo(settings.max_lag / settings.period)),
      sums_(lags_.size() * kPerLag, kBlocks) {}

void WholeMotion::add(double time, const std::vector<CrowdRobot>& robots) {
  const std::span<double> sums = sums_.frame();
  const std::size_t longest = lags_.back();
  for (const CrowdRobot& robot : robots) {
    std::deque<Pose>& poses = tracks_[robot.id].poses;
    // A frame without the robot, or a gap in the recording, ends its track.
    if (!poses.empty() && time - poses.back().time > (1 + kTolerance) * period_) poses.clear();
    poses.push_back({time, static_cast<float>(robot.x), static_cast<float>(robot.y), robot.theta});
    if (poses.size() > longest + 1) poses.pop_front();
    for (std::size_t k = 0; k < lags_.size() && lags_[k] < poses.size(); ++k) {
      const Pose& from = poses[poses.size() - 1 - lags_[k]];
      const double late = time - from.time - period_ * static_cast<double>(lags_[k]);
      if (std::abs(late) > kTolerance * period_) continue;
      const double dx = robot.x - static_cast<double>(from.x);
      const double dy = robot.y - static_cast<double>(from.y);
      const double turn = robot.theta - from.theta;
      sums[kPerLag * k] += dx * dx + dy * dy;
      sums[kPerLag * k + 1] += 1;
      if (!std::isfinite(turn)) continue;
      sums[kPerLag * k + 2] += turn * turn;
      sums[kPerLag * k + 3] += 1;
    }
  }
  sums_.endFrame();
}

static ObservableCurve curveOf(const BlockedSums& sums, const std::vector<std::size_t>& lags,
                               double period, std::size_t per_lag, std::size_t channel,
                               ObservableCurve curve) {
  for (std::size_t k = 0; k < lags.size(); ++k) {
    const std::size_t first = per_lag * k + channel;
    if (!(sums.total(first + 1) > 0)) continue;
    curve.points.push_back({period * static_cast<double>(lags[k]),
                            averageOf(sums, first, first + 1), sums.total(first + 1)});
  }
  return curve;
}

ObservableCurve WholeMotion::msd() const {
  return curveOf(sums_, lags_, period_, kPerLag, 0, {"whole_msd", "lag", "s", "m^2", {}});
}

ObservableCurve WholeMotion::angularMsd() const {
  return curveOf(sums_, lags_, period_, kPerLag, 2, {"whole_angular_msd", "lag", "s", "rad^2", {}});
}

}  // namespace lab::collective
