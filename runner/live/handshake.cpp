#include "runner/live/handshake.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/experiment_messages.hpp"

namespace lab::runner {
namespace {

constexpr double kTurnRate = 2;                      // [rad/s]
constexpr std::int64_t kTurnTimeout_us = 3'000'000;  // about six times what the tracker needs
// A board on a serial line needs up to 2.5 s until robot_bridge opens the line, and 1 s for its
// settings.
constexpr std::int64_t kHandshakeTimeout_us = 10'000'000;
constexpr std::int64_t kSwing_us = 600'000;  // 70 degrees
constexpr int kRequestTries = 2;

}  // namespace

Handshake::Handshake(const Experiment& experiment)
    : experiment_(experiment),
      speed_(std::min(kTurnRate * experiment.hardware.diameter / 2,
                      experiment.hardware.max_wheel_speed)) {
  const Camera& camera = experiment.camera;
  if (!needsHandshake(camera)) return;
  for (const RobotSpec& robot : experiment.robots) {
    const bool in_view = (robot.body == Body::kSerial) != isPainted(camera);
    if (in_view && robot.body != Body::kReplay) waiting_.push_back({robot.id, 0});
  }
}

void Handshake::see(const tracked_frame_t& frame) {
  known_.clear();
  for (const tracked_pose_t& pose : frame.robots) known_.insert(pose.robot_id);
}

bool Handshake::advance(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed) {
  if (waiting_.empty()) return false;
  if (begun_ && !isOver(utime, obeyed)) return swing(utime);
  begun_ = true;
  std::erase_if(waiting_, [this](const Turn& turn) { return known_.contains(turn.robot_id); });
  if (waiting_.empty()) return false;
  turn(utime);
  return true;
}

bool Handshake::isOver(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed) {
  const Turn current = waiting_.front();
  if (known_.contains(current.robot_id)) return true;
  if (obeyed_utime_ == 0 && obeyed(current.robot_id)) {
    obeyed_utime_ = utime;
    swung_utime_ = utime;
  }
  const bool turned = obeyed_utime_ != 0;
  const std::int64_t since = turned ? obeyed_utime_ : told_utime_;
  if (utime - since < (turned ? kTurnTimeout_us : kHandshakeTimeout_us)) return false;
  waiting_.erase(waiting_.begin());
  if (current.tries + 1 < kRequestTries) {
    waiting_.push_back({current.robot_id, current.tries + 1});
  } else {
    unknown_.push_back(current.robot_id);
  }
  return true;
}

void Handshake::turn(std::int64_t utime) {
  speed_ = std::abs(speed_);
  tell();
  told_utime_ = utime;
  obeyed_utime_ = 0;
}

/// Reverses the direction. A cap that reverses together with the robot is stronger evidence than
/// one that only turns.
bool Handshake::swing(std::int64_t utime) {
  if (obeyed_utime_ == 0 || utime - swung_utime_ < kSwing_us) return false;
  speed_ = -speed_;
  swung_utime_ = utime;
  tell();
  return true;
}

void Handshake::tell() {
  const std::int32_t chosen = waiting_.front().robot_id;
  command_ = standCommand(experiment_);
  for (robot_order_t& order : command_.orders) {
    std::erase(order.robot_ids, chosen);
    order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
  }
  std::erase_if(command_.orders, [](const robot_order_t& order) { return order.num_robots == 0; });
  robot_order_t drive{};
  drive.mode = robot_order_t::DRIVE;
  drive.robot_ids = {chosen};
  drive.num_robots = 1;
  drive.wheel_left = -speed_;
  drive.wheel_right = speed_;
  command_.orders.push_back(drive);
  command_.num_orders = static_cast<std::int32_t>(command_.orders.size());
}

}  // namespace lab::runner
