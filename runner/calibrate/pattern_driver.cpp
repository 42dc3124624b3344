#include "runner/calibrate/pattern_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"

namespace lab::runner {
namespace {

using calibration::PatternStep;

constexpr std::int64_t kFresh_us = 300'000;  // largest age of a pose
constexpr std::int64_t kPoseTimeout_us = 3'000'000;
constexpr std::int64_t kPatternEchoTimeout_us = 2'000'000;
constexpr std::int64_t kMotionTimeout_us = 10'000'000;
constexpr std::int64_t kStuck_us = 1'500'000;
constexpr std::int64_t kRest_us = 300'000;
constexpr std::int64_t kLastFrames_us = 300'000;  // in addition to the camera's delay
constexpr double kShare = 0.3;                    // part of the full speed
constexpr double kShareMore = 0.15;               // added while the wheels do not turn
constexpr double kMostShare = 0.8;
constexpr double kTurnTolerance = 0.13;  // [rad]
constexpr double kTurned = 0.05;         // [rad] above the noise
constexpr double kMoved = 0.004;         // [m] above the noise
constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr int kMostTurns = 10;

}  // namespace

PatternDriver::PatternDriver(const Experiment& experiment, std::int32_t robot,
                             const calibration::Motors& believed, calibration::Pattern pattern,
                             const SeenRobots& scene, DriveActions actions)
    : experiment_(experiment),
      robot_(robot),
      believed_(believed),
      pattern_(std::move(pattern)),
      seen_robots_(scene),
      actions_(std::move(actions)) {}

void PatternDriver::see(const tracked_frame_t& frame) {
  for (const tracked_pose_t& pose : frame.robots) {
    if (pose.robot_id != robot_) continue;
    track_.push_back({frame.utime, {0, pose.x, pose.y, pose.theta}});
  }
}

void PatternDriver::hear(const robot_state_t& state) {
  if (state.robot_id != robot_ || isOver()) return;
  if ((state.flags & robot_state_t::FLAG_STOPPED) != 0) {
    fail(name() + " is stopped: release it with lab stop --clear and calibrate again");
  } else if ((state.flags & robot_state_t::FLAG_REJECTED) != 0 && actions_.obeyed()) {
    fail(name() + " rejects the commands; the messages of the lab give the reason");
  }
}

void PatternDriver::tick(std::int64_t now) {
  if (now_ == 0) entered_ = now;
  now_ = now;
  switch (phase_) {
    case Phase::kPlan:
      return plan();
    case Phase::kTurn:
      return turn();
    case Phase::kRest:
      return rest();
    case Phase::kLeave:
      return leave();
    case Phase::kAwaitEcho:
      return awaitEcho();
    case Phase::kHold:
      return hold();
    case Phase::kLastFrames:
      if (inPhase() > kLastFrames_us + units::microseconds(experiment_.camera.delay)) {
        enter(Phase::kOver);
      }
      return;
    case Phase::kOver:
      return;
  }
}

void PatternDriver::enter(Phase phase) {
  phase_ = phase;
  entered_ = now_;
}

void PatternDriver::fail(const std::string& why) {
  failure_ = why;
  actions_.stand();
  enter(Phase::kOver);
}

std::string PatternDriver::name() const { return fmt::format("robot {}", robot_); }

const SeenRobot* PatternDriver::recentPose() const {
  const auto seen = seen_robots_.find(robot_);
  return seen != seen_robots_.end() && now_ - seen->second.utime < kFresh_us ? &seen->second
                                                                             : nullptr;
}

calibration::Surroundings PatternDriver::surroundings() const {
  calibration::Surroundings around{
      experiment_.arena_width, experiment_.arena_height, {}, experiment_.hardware.diameter};
  for (const auto& [id, seen] : seen_robots_) {
    if (id != robot_) around.others.push_back(seen.place);
  }
  return around;
}

std::string PatternDriver::noRoomText() const {
  const calibration::Place at = seen_robots_.at(robot_).place;
  std::string nearest;
  double distance = 1e9;
  for (const auto& [id, seen] : seen_robots_) {
    const double found = std::hypot(seen.place.x - at.x, seen.place.y - at.y);
    if (id == robot_ || found >= distance) continue;
    distance = found;
    nearest = fmt::format("; robot {} is {:.0f} cm away", id, 100 * found);
  }
  return fmt::format(
      "{} has no room at ({:.0f}, {:.0f}) cm: it drives up to {:.0f} cm in a direction and needs "
      "{:.0f} cm of clearance{}; move it, and calibrate it alone: --robot {}",
      name(), 100 * at.x, 100 * at.y,
      100 * calibration::reachOf(pattern_, experiment_.hardware.diameter),
      100 * calibration::kClearance, nearest, robot_);
}

// Chooses the heading of the pattern, or an escape path if no heading has room.
void PatternDriver::plan() {
  const SeenRobot* seen = recentPose();
  if (seen == nullptr) {
    if (inPhase() > kPoseTimeout_us) {
      fail(name() + " is not seen by the tracker: is it in the arena, and is the tracker running?");
    }
    return;
  }
  const auto heading = calibration::clearHeading(pattern_, seen->place, surroundings());
  if (heading && std::fabs(wrapAngle(*heading - seen->place.theta)) < 1e-6) {
    return beginStep();
  }
  const auto escape =
      heading ? std::nullopt : calibration::escapePath(pattern_, seen->place, surroundings());
  if (!heading && !escape) return fail(noRoomText());
  if (++turns_ > kMostTurns) return fail(name() + " cannot hold a heading: do its wheels slip?");
  escape_ = escape ? escape->distance : 0;
  turnTo(escape ? escape->heading : *heading);
}

void PatternDriver::drive(double left_share, double right_share) {
  const double max = experiment_.hardware.max_wheel_speed;
  actions_.drive(left_share * max, right_share * max);
}

void PatternDriver::turnTo(double heading) {
  from_ = recentPose()->place;
  target_ = heading;
  turn_sign_ = wrapAngle(target_ - from_.theta) < 0 ? -1 : 1;
  share_ = kShare;
  drive(-turn_sign_ * share_, turn_sign_ * share_);
  enter(Phase::kTurn);
}

/// The share of the full speed. It rises while the robot does not move, because the dead band of
/// its wheels may be wide.
double PatternDriver::shareFor(bool moves) const {
  const double wanted = kShare + kShareMore * static_cast<double>(inPhase() / kStuck_us);
  return moves ? share_ : std::clamp(wanted, share_, kMostShare);
}

void PatternDriver::turn() {
  if (inPhase() > kMotionTimeout_us) {
    return fail(name() + " does not turn as commanded: are its motors on and its wheels free?");
  }
  const SeenRobot* seen = recentPose();
  if (seen == nullptr) return fail(name() + " is no longer seen by the tracker");
  const double to_turn = wrapAngle(target_ - seen->place.theta);
  const bool beyond = to_turn * turn_sign_ < 0 && std::fabs(to_turn) < kFullTurn / 4;
  if (std::fabs(to_turn) < kTurnTolerance || beyond) {
    actions_.stand();
    return enter(Phase::kRest);
  }
  const double turned = std::fabs(wrapAngle(seen->place.theta - from_.theta));
  const double share = shareFor(turned > kTurned);
  if (share == share_) return;
  share_ = share;
  drive(-turn_sign_ * share_, turn_sign_ * share_);
}

// Drives along the escape path, away from walls and robots that are too near.
void PatternDriver::leave() {
  if (inPhase() > kMotionTimeout_us) {
    return fail(name() + " does not drive as commanded: are its motors on and its wheels free?");
  }
  const SeenRobot* seen = recentPose();
  if (seen == nullptr) return fail(name() + " is no longer seen by the tracker");
  const double gone = std::hypot(seen->place.x - from_.x, seen->place.y - from_.y);
  if (gone >= escape_) {
    escape_ = 0;
    actions_.stand();
    return enter(Phase::kRest);
  }
  const double share = shareFor(gone > kMoved);
  if (share == share_) return;
  share_ = share;
  drive(share_, share_);
}

void PatternDriver::rest() {
  if (inPhase() > kPatternEchoTimeout_us) {
    return fail(name() + (actions_.obeyed() ? " is no longer seen by the tracker"
                                            : " does not answer: is it switched on?"));
  }
  const SeenRobot* seen = recentPose();
  if (inPhase() <= kRest_us || !actions_.obeyed() || seen == nullptr) return;
  if (escape_ == 0) return enter(Phase::kPlan);
  from_ = seen->place;
  share_ = kShare;
  drive(share_, share_);
  enter(Phase::kLeave);
}

void PatternDriver::beginStep() {
  if (next_step_ == pattern_.size()) {
    actions_.stand();
    return enter(Phase::kLastFrames);
  }
  const PatternStep& step = pattern_[next_step_];
  actions_.drive(step.left, step.right);
  driven_.push_back({step, 0, 0});
  enter(Phase::kAwaitEcho);
}

// The step begins when the robot echoes its command.
void PatternDriver::awaitEcho() {
  if (inPhase() > kPatternEchoTimeout_us)
    return fail(name() + " does not answer: is it switched on?");
  if (!actions_.obeyed()) return;
  driven_.back().from = std::max(now_, entered_ + units::microseconds(calibration::kSettleTime));
  enter(Phase::kHold);
}

void PatternDriver::hold() {
  Driven& driven = driven_.back();
  if (now_ < driven.from + units::microseconds(driven.step.duration)) return;
  driven.to = now_;
  ++next_step_;
  beginStep();
}

std::vector<calibration::CheckedSegment> PatternDriver::segments() const {
  std::vector<calibration::CheckedSegment> segments;
  const RobotHardware& hardware = experiment_.hardware;
  for (const Driven& driven : driven_) {
    calibration::CheckedSegment checked{driven.step.left, driven.step.right, {}};
    calibration::Segment& segment = checked.segment;
    segment.duty_left = calibration::dutyFor(believed_.left, driven.step.left,
                                             hardware.max_wheel_speed, hardware.pwm_steps);
    segment.duty_right = calibration::dutyFor(believed_.right, driven.step.right,
                                              hardware.max_wheel_speed, hardware.pwm_steps);
    segment.frames =
        static_cast<int>(units::seconds(driven.to - driven.from) * experiment_.camera.fps);
    for (const auto& [utime, point] : track_) {
      if (utime < driven.from || utime > driven.to) continue;
      segment.track.push_back(point);
      segment.track.back().time = units::seconds(utime - driven.from);
    }
    segments.push_back(std::move(checked));
  }
  return segments;
}

}  // namespace lab::runner
