#include "runner/script/step_condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace lab::runner {
namespace {

// A robot counts as inside for this long after its last pose, as the tracker may miss it in frames.
constexpr std::int64_t kPoseLifetime_us = 500'000;

}  // namespace

StepCondition::StepCondition(const Experiment& experiment, const EndCondition& until,
                             const TumbleCount& tumbles, std::int64_t utime)
    : until_(until),
      estimate_(experiment, until),
      crowd_(experiment, until),
      begin_utime_(utime),
      tumbles_before_(tumbles.total(until.robot)) {
  for (const RobotSpec& robot : experiment.robots) robots_.insert(robot.id);
}

bool StepCondition::concerns(std::int32_t robot) const {
  return until_.robot != 0 ? robot == until_.robot : robots_.contains(robot);
}

double StepCondition::distance(const tracked_pose_t& pose) const {
  const double dx = std::abs(pose.x - until_.x);
  const double dy = std::abs(pose.y - until_.y);
  if (until_.region == Region::kCircle) return std::max(0.0, std::hypot(dx, dy) - until_.radius);
  return std::hypot(std::max(0.0, dx - until_.width / 2), std::max(0.0, dy - until_.height / 2));
}

void StepCondition::take(const tracked_frame_t& frame) {
  if (until_.region == Region::kNone || met_ || frame.utime < begin_utime_) return;
  for (const tracked_pose_t& pose : frame.robots) {
    if (!concerns(pose.robot_id)) continue;
    const double outside = distance(pose);
    if (outside < nearest_) {
      nearest_ = outside;
      nearest_robot_ = pose.robot_id;
    }
    if (outside > 0) {
      inside_.erase(pose.robot_id);
    } else {
      inside_[pose.robot_id] = frame.utime;
    }
  }
  std::erase_if(inside_, [&frame](const auto& robot) {
    return frame.utime - robot.second > kPoseLifetime_us;
  });
  most_inside_ = std::max(most_inside_, inside_.size());
  const bool all = until_.robot == 0 && until_.who == Who::kAll;
  if (inside_.size() >= (all ? robots_.size() : 1)) met_ = frame.utime;
}

void StepCondition::take(const analysis_t& analysis) {
  if (until_.estimate.empty() || met_ || analysis.utime < begin_utime_) return;
  if (estimate_.take(analysis) && estimate_.holds()) met_ = analysis.utime;
}

void StepCondition::take(const collective_t& message) {
  if (until_.observable.empty() || met_ || message.utime < begin_utime_) return;
  if (crowd_.take(message) && crowd_.holds()) met_ = message.utime;
}

void StepCondition::take(const TumbleCount& tumbles) {
  if (until_.tumbles == 0 || met_) return;
  tumbles_ = tumbles.total(until_.robot) - tumbles_before_;
  if (tumbles_ >= until_.tumbles) met_ = tumbles.lastUtime();
}

std::string StepCondition::progress() const {
  if (!until_.estimate.empty()) return estimate_.progress();
  if (!until_.observable.empty()) return crowd_.progress();
  if (until_.tumbles != 0) {
    return fmt::format("{} tumbles, wanted {}", tumbles_, until_.tumbles);
  }
  if (until_.robot == 0 && until_.who == Who::kAll) {
    return fmt::format("at most {} of {} robots were there at the same time", most_inside_,
                       robots_.size());
  }
  if (!std::isfinite(nearest_)) return "no robot was seen";
  return fmt::format("robot {} came nearest, to {:.1f} cm", nearest_robot_,
                     nearest_ / units::kCentimetre);
}

}  // namespace lab::runner
