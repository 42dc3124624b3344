#include "analyzer/report/poses/pose_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using std::numbers::pi;

using units::kPercents;
constexpr double kBeyondATurn = 2 * pi * 1.001;  // rounded numbers may exceed 2 pi slightly
constexpr std::int64_t kFewSteps = 20;
constexpr std::int64_t kMuchOneIn = 10;  // share of the steps: robots may be confused
constexpr double kFewFrames = 1.5;       // periods between consecutive frames, at most
constexpr double kQuarterTurnInDegrees = 90;
constexpr double kLeastAlong = 0.1;  // below, noise of the positions dominates
constexpr double kSureAlong = 6;     // standard deviations of random directions
constexpr double kFarMoreAlong = 3;
constexpr double kSlowest_s = 5;       // between frames; robots drive a body length in this time
constexpr double kSlowestMs_s = 1000;  // above, times in ms would be slower than a frame per second
constexpr double kFastest_s = 1e-3;    // faster than cameras of an arena

/// Changes of the headings between frames, and the direction of motion relative to them.
struct HeadingSteps {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  std::int64_t steps = 0;
  std::int64_t beyond_half_turn = 0;
  double path = 0;     ///< sum of squared steps
  double radians = 0;  ///< the same weighted with cos(2 angle between step and theta)
  double degrees = 0;  ///< and theta pi / 180

  void take(const Pose& from, const Pose& to) {
    ++steps;
    if (std::abs(to.theta - from.theta) > pi) ++beyond_half_turn;
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    // Twice the angle: a robot may drive backwards.
    const auto along = [&](double theta) {
      return (dx * dx - dy * dy) * std::cos(2 * theta) + 2 * dx * dy * std::sin(2 * theta);
    };
    path += dx * dx + dy * dy;
    radians += along(from.theta);
    degrees += along(from.theta * pi / 180);
  }

  [[nodiscard]] bool isBeyondATurn() const {
    return std::max(std::abs(low), std::abs(high)) > kBeyondATurn;
  }
  [[nodiscard]] bool jumps() const {
    return steps >= kFewSteps && beyond_half_turn * kMuchOneIn > steps;
  }
  [[nodiscard]] bool isAlongDegrees() const {
    const double share = path > 0 ? degrees / path : 0;
    return high - low > kQuarterTurnInDegrees && share > kLeastAlong &&
           share * std::sqrt(static_cast<double>(steps)) > kSureAlong &&
           share * path > kFarMoreAlong * std::abs(radians);
  }
};

HeadingSteps headingSteps(const PoseFile& poses) {
  struct Last {
    double time;
    Pose pose;
  };
  HeadingSteps all;
  std::map<int, Last> last;
  poses.eachFrame([&](const PoseFrame& frame, std::span<const Pose> robots) {
    for (const Pose& pose : robots) {
      if (!pose.valid) continue;
      all.low = std::min(all.low, pose.theta);
      all.high = std::max(all.high, pose.theta);
      const auto [before, is_new] = last.try_emplace(pose.robot, Last{frame.time, pose});
      if (is_new) continue;
      if (frame.time - before->second.time < kFewFrames * poses.frame_period) {
        all.take(before->second.pose, pose);
      }
      before->second = {frame.time, pose};
    }
  });
  return all;
}

std::string headingDoubt(const PoseFile& poses) {
  if (!poses.headings) return {};
  const HeadingSteps steps = headingSteps(poses);
  if (!steps.isBeyondATurn()) return {};
  const bool along = steps.isAlongDegrees();
  if (!along && !steps.jumps()) return {};
  std::string text = fmt::format("headings cannot be radians: they go from {} to {}",
                                 shortText(steps.low), shortText(steps.high));
  if (steps.jumps()) {
    text += fmt::format(
        ", and turn by more than pi in {:.0f} % of the steps from frame to frame",
        kPercents * static_cast<double>(steps.beyond_half_turn) / static_cast<double>(steps.steps));
  }
  return text +
         (along ? "; the motion is along theta pi / 180: they are in degrees"
                : "; are they in degrees?") +
         " (expected theta in rad)";
}

std::string timeDoubt(const PoseFile& poses) {
  const double period = poses.frame_period;
  if (!poses.times || poses.frames.size() < 2) return {};
  const double span = poses.frames.back().time - poses.frames.front().time;
  const std::string rate =
      fmt::format("{} frames a second over {}", shortText(1 / period), durationText(span));
  if (period > kSlowest_s) {
    return fmt::format(
        "times can hardly be s: that would be {}; are they in {}? (leave the column out "
        "and give --fps, or write s)",
        rate, period < kSlowestMs_s ? "ms" : "us");
  }
  if (period < kFastest_s) {
    return fmt::format(
        "times can hardly be s: that would be {}; are they in minutes or hours? (leave "
        "the column out and give --fps, or write s)",
        rate);
  }
  return {};
}

}  // namespace

std::vector<std::string> unitWarnings(const PoseFile& poses) {
  std::vector<std::string> doubts;
  for (std::string doubt : {headingDoubt(poses), timeDoubt(poses)}) {
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  }
  return doubts;
}

}  // namespace lab::report
