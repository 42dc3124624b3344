#include "projector_ctl/scene/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "common/programs/program.hpp"

namespace lab::projector {
namespace {

// Lower bounds of the variances, so that poses without noise have finite weights.
constexpr double kLeastVariance = 1e-10;     // [m^2]
constexpr double kLeastTurnVariance = 1e-8;  // [rad^2]
constexpr double kSigmas = 6;                // larger deviations are jumps, not noise
constexpr std::size_t kFewest = 3;           // poses in a window
constexpr double kStraight = 1e-6;           // [rad/s] slower turns are treated as straight lines

using units::seconds;

double shrunk(double rate, double variance) {
  return rate * std::max(0.0, 1 - variance / std::max(rate * rate, 1e-300));
}

struct Step {
  double x;
  double y;
};

/// Displacement at unit speed from heading `theta` in `time`, which may be negative.
Step arc(double theta, double turn, double time) {
  if (std::abs(turn) < kStraight) return {time * std::cos(theta), time * std::sin(theta)};
  const double end = theta + turn * time;
  return {(std::sin(end) - std::sin(theta)) / turn, (std::cos(theta) - std::cos(end)) / turn};
}

}  // namespace

bool Track::reaches(const Pose& from, const Pose& to) {
  const double time = seconds(to.utime - from.utime);
  const double noise = kSigmas * std::sqrt(1 / from.weight + 1 / to.weight);
  const double turn_noise = kSigmas * std::sqrt(1 / from.turn_weight + 1 / to.turn_weight);
  const double way = std::hypot(to.place.x - from.place.x, to.place.y - from.place.y);
  const double turn = std::abs(wrapAngle(to.place.theta - from.place.theta));
  return way <= kFastest * time + noise && turn <= kFastestTurn * time + turn_noise;
}

void Track::add(const ObservedRobot& robot, std::int64_t utime) {
  const auto usable = [](double variance) { return std::isfinite(variance) && variance >= 0; };
  if (!usable(robot.variance) || !usable(robot.turn_variance)) return;
  Pose pose{utime,
            {robot.x, robot.y, robot.theta},
            1 / std::max(robot.variance, kLeastVariance),
            1 / std::max(robot.turn_variance, kLeastTurnVariance)};
  if (!hasPose()) {
    append(pose);
    return;
  }
  // If the clock was set back by more than the longest gap, a new track begins.
  const double since = seconds(utime - poses_.back().utime);
  if (since <= 0 && since >= -kLongestGap) return;
  if (std::abs(since) > kLongestGap) {
    poses_.clear();
  } else if (!reaches(poses_.back(), pose)) {
    const bool agrees = !outlier_.empty() && reaches(outlier_.back(), pose);
    if (!agrees) {
      outlier_ = {pose};
      return;
    }
    poses_ = std::move(outlier_);
  }
  outlier_.clear();
  append(pose);
}

void Track::append(Pose pose) {
  if (hasPose()) {
    const double before = poses_.back().place.theta;
    pose.place.theta = before + wrapAngle(pose.place.theta - before);
  }
  poses_.push_back(pose);
  const auto old = [&](const Pose& one) { return seconds(pose.utime - one.utime) > kWindow; };
  while (poses_.size() > kFewest && old(poses_.front())) poses_.erase(poses_.begin());
  fit();
}

void Track::fit() {
  const std::int64_t end = poses_.back().utime;
  double weights = 0;
  double time = 0;
  double theta = 0;
  for (const Pose& pose : poses_) {
    weights += pose.turn_weight;
    time += pose.turn_weight * seconds(pose.utime - end);
    theta += pose.turn_weight * pose.place.theta;
  }
  time /= weights;
  theta /= weights;
  double square = 0;
  double product = 0;
  for (const Pose& pose : poses_) {
    const double from_mean = seconds(pose.utime - end) - time;
    square += pose.turn_weight * from_mean * from_mean;
    product += pose.turn_weight * from_mean * (pose.place.theta - theta);
  }
  turn_ = square > 0 ? shrunk(product / square, 1 / square) : 0;
  fitted_.theta = theta - turn_ * time;

  weights = 0;
  Step place{};
  Step way{};
  for (const Pose& pose : poses_) {
    const Step step = arc(fitted_.theta, turn_, seconds(pose.utime - end));
    weights += pose.weight;
    place.x += pose.weight * pose.place.x;
    place.y += pose.weight * pose.place.y;
    way.x += pose.weight * step.x;
    way.y += pose.weight * step.y;
  }
  place = {place.x / weights, place.y / weights};
  way = {way.x / weights, way.y / weights};
  square = 0;
  product = 0;
  for (const Pose& pose : poses_) {
    const Step step = arc(fitted_.theta, turn_, seconds(pose.utime - end));
    const Step from_mean{step.x - way.x, step.y - way.y};
    square += pose.weight * (from_mean.x * from_mean.x + from_mean.y * from_mean.y);
    product += pose.weight *
               (from_mean.x * (pose.place.x - place.x) + from_mean.y * (pose.place.y - place.y));
  }
  speed_ = square > 0 ? shrunk(product / square, 1 / square) : 0;
  fitted_.x = place.x - speed_ * way.x;
  fitted_.y = place.y - speed_ * way.y;
}

RobotPose Track::last() const { return poses_.back().place; }

RobotPose Track::before() const { return poses_[poses_.size() - 2].place; }

RobotPose Track::predicted(std::int64_t utime) const {
  const double time = std::clamp(seconds(utime - lastUtime()), -kWindow, kFurthest);
  const Step step = arc(fitted_.theta, turn_, time);
  return {fitted_.x + speed_ * step.x, fitted_.y + speed_ * step.y, fitted_.theta + turn_ * time};
}

void RobotTracks::add(const ObservedFrame& frame) {
  for (const ObservedRobot& robot : frame.robots) {
    // Written so that NaN counts as too small.
    if (!(robot.confidence >= kLeastConfidence) || !known_.contains(robot.id)) continue;
    if (!std::isfinite(robot.x) || !std::isfinite(robot.y) || !std::isfinite(robot.theta)) continue;
    tracks_[robot.id].add(robot, frame.utime);
  }
}

void RobotTracks::report(std::int32_t id, const std::string& program, std::int64_t utime) {
  if (!known_.contains(id)) return;
  Report& report = reports_[id];
  if (utime < report.utime) return;
  report.program = program.size() <= kLongestProgramName ? program : "";
  report.utime = utime;
}

const Track* RobotTracks::track(std::int32_t id) const {
  const auto found = tracks_.find(id);
  return found != tracks_.end() && found->second.hasPose() ? &found->second : nullptr;
}

bool RobotTracks::runs(std::int32_t id, const std::string& program, std::int64_t utime,
                       double stale) const {
  const auto found = reports_.find(id);
  return found != reports_.end() && found->second.program == program &&
         seconds(utime - found->second.utime) <= stale;
}

}  // namespace lab::projector
