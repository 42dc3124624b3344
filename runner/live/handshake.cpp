#include "runner/live/handshake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/experiment/experiment_messages.hpp"

namespace lab::runner {
namespace {

constexpr double kTurnRate = 2;      // [rad/s] highest
constexpr double kLeastSpeed = 0.5;  // [1] of it
constexpr int kSpeedLevels = 8;
constexpr std::int64_t kRound_us = 500'000;  // 60 degrees, five comparisons by the tracker
// A board on a serial line needs up to 2.5 s until robot_bridge opens the line, and 1 s for its
// settings.
constexpr std::int64_t kFirstEchoTimeout_us = 10'000'000;
constexpr std::int64_t kEchoTimeout_us = 2'000'000;
// The tracker compares motions when all reports have arrived, which are at most a second late.
constexpr std::int64_t kLastReports_us = 1'500'000;
constexpr std::int64_t kKnownFor_us = 500'000;  // a cap may be missed in some frames
constexpr int kPasses = 2;

}  // namespace

Handshake::Handshake(const Experiment& experiment)
    : experiment_(experiment),
      speed_(std::min(kTurnRate * experiment.hardware.diameter / 2,
                      experiment.hardware.max_wheel_speed)) {
  const Camera& camera = experiment.camera;
  if (!needsHandshake(camera)) return;
  for (const RobotSpec& robot : experiment.robots) {
    const bool in_view = (robot.body == Body::kSerial) != isPainted(camera);
    if (in_view && robot.body != Body::kReplay) waiting_.push_back(robot.id);
  }
}

void Handshake::see(const tracked_frame_t& frame) {
  frame_utime_ = frame.utime;
  for (const tracked_pose_t& pose : frame.robots) known_utime_[pose.robot_id] = frame.utime;
}

bool Handshake::isKnown(std::int32_t robot_id) const {
  const auto known = known_utime_.find(robot_id);
  return known != known_utime_.end() && known->second >= frame_utime_ - kKnownFor_us;
}

void Handshake::forgetKnown() {
  std::erase_if(waiting_, [this](std::int32_t id) { return isKnown(id); });
}

bool Handshake::advance(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed) {
  if (waiting_.empty()) return false;
  const bool all = std::ranges::all_of(waiting_, [this](std::int32_t id) { return isKnown(id); });
  if (all) {
    waiting_.clear();
    return false;
  }
  if (pass_ < 0) {
    beginPass(utime);
    return true;
  }
  if (!isRoundOver(utime, obeyed)) return false;
  if (++round_ < code_.rounds) {
    beginRound(utime);
    return true;
  }
  if (round_ == code_.rounds) {  // all stand until the tracker has the last reports
    command_ = standCommand(experiment_);
    told_utime_ = utime;
    return true;
  }
  forgetKnown();
  if (pass_ + 1 >= kPasses) unknown_ = std::exchange(waiting_, {});
  if (waiting_.empty()) return false;
  beginPass(utime);
  return true;
}

bool Handshake::isRoundOver(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed) {
  if (round_ == code_.rounds) return utime - told_utime_ >= kLastReports_us;
  const bool first = round_ == 0;
  if (obeyed_utime_ == 0) {
    std::set<std::int32_t> missing;
    for (const std::int32_t id : waiting_) {
      if (!silent_.contains(id) && !obeyed(id)) missing.insert(id);
    }
    const std::int64_t timeout = first && pass_ == 0 ? kFirstEchoTimeout_us : kEchoTimeout_us;
    if (!missing.empty() && utime - told_utime_ < timeout) return false;
    if (first) silent_ = std::move(missing);
    obeyed_utime_ = utime;
  }
  return utime - obeyed_utime_ >= kRound_us;
}

void Handshake::beginPass(std::int64_t utime) {
  ++pass_;
  forgetKnown();
  // Robots that could not be told apart get words that differ in other rounds.
  std::ranges::reverse(waiting_);
  silent_.clear();
  code_ = turningCode(waiting_.size());
  round_ = 0;
  beginRound(utime);
}

/// Speed of the right wheel of a robot in this round [m/s]; the left wheel has its negative.
/// The word gives the direction. The magnitude differs between robots and rounds too: the tracker
/// learns more from a change that few robots make.
double Handshake::speedOf(std::size_t robot) const {
  const double sequence = static_cast<double>(robot + 1) * (round_ + 1) * std::numbers::phi;
  const int level = static_cast<int>(kSpeedLevels * (sequence - std::floor(sequence)));
  const double share = kLeastSpeed + (1 - kLeastSpeed) * level / (kSpeedLevels - 1);
  const bool left = ((code_.words[robot] >> round_) & 1) != 0;
  return (left ? share : -share) * speed_;
}

void Handshake::beginRound(std::int64_t utime) {
  std::map<double, std::vector<std::int32_t>> turning;
  for (std::size_t i = 0; i < waiting_.size(); ++i) turning[speedOf(i)].push_back(waiting_[i]);
  command_ = standCommand(experiment_);
  for (robot_order_t& order : command_.orders) {
    std::erase_if(order.robot_ids, [this](std::int32_t id) {
      return std::ranges::find(waiting_, id) != waiting_.end();
    });
    order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
  }
  for (auto& [speed, ids] : turning) {
    robot_order_t drive{};
    drive.mode = robot_order_t::DRIVE;
    drive.num_robots = static_cast<std::int32_t>(ids.size());
    drive.robot_ids = std::move(ids);
    drive.wheel_left = -speed;
    drive.wheel_right = speed;
    command_.orders.push_back(std::move(drive));
  }
  std::erase_if(command_.orders, [](const robot_order_t& order) { return order.num_robots == 0; });
  command_.num_orders = static_cast<std::int32_t>(command_.orders.size());
  told_utime_ = utime;
  obeyed_utime_ = 0;
}

}  // namespace lab::runner
