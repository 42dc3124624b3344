#include "dds_gateway/ros/command_arbiter.hpp"

#include <algorithm>

namespace lab::gateway {
namespace {

constexpr std::int64_t kLabAlive_us = 2'000'000;   // the lab repeats its commands at 5 Hz
constexpr std::int64_t kStopAlive_us = 500'000;    // a stop is repeated at 10 Hz
constexpr std::int64_t kDriveSpacing_us = 20'000;  // one message a tick
constexpr std::int64_t kDriveRepeat_us = 100'000;
constexpr std::int32_t kDriveLease_ms = 500;
constexpr std::int64_t kOrderRepeat_us = 500'000;
constexpr std::int32_t kOrderLease_ms = 2000;
constexpr std::int32_t kEndLease_ms = 1;     // then robots obey the lab's next command
constexpr std::size_t kMostOrdersATick = 4;  // the burst budget, lcmtypes/README.md

void add(robot_order_t& order, std::int32_t robot) {
  order.robot_ids.push_back(robot);
  order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
}

void add(robot_command_t& command, robot_order_t order) {
  command.orders.push_back(std::move(order));
  command.num_orders = static_cast<std::int32_t>(command.orders.size());
}

bool sameWheels(const robot_order_t& a, const robot_order_t& b) {
  return a.mode == b.mode && a.wheel_left == b.wheel_left && a.wheel_right == b.wheel_right;
}

}  // namespace

std::string textOf(Answer answer) {
  switch (answer) {
    case Answer::kTaken:
      return "taken";
    case Answer::kClamped:
      return "slowed down to the wheels' limit";
    case Answer::kNotFinite:
      return "nan or infinite";
    case Answer::kOutOfRange:
      return "out of range";
    case Answer::kNoRobot:
      return "no robot that may be driven from ROS 2 (gateway.command_robots)";
    case Answer::kNoProgram:
      return "no program of the experiment";
    case Answer::kNoLoading:
      return "texts of programs are not allowed (gateway.load_programs)";
    case Answer::kBadProgram:
      return "the text is no program (the reason is in the log)";
    case Answer::kOwned:
      return "owned by another publisher";
    case Answer::kStopped:
      return "stopped (lab stop --clear releases)";
    case Answer::kLabHolds:
      return "the lab holds the robot";
    case Answer::kFlood:
      return "too many messages a second";
  }
  return "";
}

Answer CommandArbiter::refusal(std::int32_t robot, dds::WriterId writer, std::int64_t now) const {
  if (!robots_.contains(robot)) return Answer::kNoRobot;
  const auto stop = stop_utime_.find(robot);
  const bool asked = stop != stop_utime_.end() && now - stop->second < kStopAlive_us;
  if (asked || latched_.contains(robot)) return Answer::kStopped;
  const auto lab = lab_.find(robot);
  const bool lab_holds = lab != lab_.end() && lab->second.mode != robot_order_t::TABLE &&
                         now - lab->second.utime < kLabAlive_us;
  if (lab_holds) return Answer::kLabHolds;
  const auto hold = holds_.find(robot);
  const bool owned = hold != holds_.end() && hold->second.writer != writer &&
                     now - hold->second.heard_utime <= timeout_us_;
  return owned ? Answer::kOwned : Answer::kTaken;
}

Answer CommandArbiter::drive(std::int32_t robot, dds::WriterId writer, const ros::Twist& twist,
                             std::int64_t now) {
  if (!isFinite(twist)) return Answer::kNotFinite;
  const Answer answer = refusal(robot, writer, now);
  if (answer != Answer::kTaken) return answer;
  const WheelSpeeds wheels = toWheels(twist, wheels_);
  robot_order_t order{};
  order.mode = robot_order_t::DRIVE;
  order.wheel_left = wheels.left;
  order.wheel_right = wheels.right;
  Hold& hold = holds_[robot];
  drive_changed_ = drive_changed_ || !hold.driven || !sameWheels(hold.order, order);
  hold = {writer, now, true, false, std::move(order), 0, 0};
  given_back_.erase(robot);
  return wheels.clamped ? Answer::kClamped : Answer::kTaken;
}

Answer CommandArbiter::command(const std::vector<std::int32_t>& robots, dds::WriterId writer,
                               const robot_order_t& order, std::int64_t now) {
  Answer first = Answer::kTaken;
  ++seq_;
  for (const std::int32_t robot : robots) {
    const Answer answer = refusal(robot, writer, now);
    if (answer != Answer::kTaken) {
      if (first == Answer::kTaken) first = answer;
      continue;
    }
    Hold& hold = holds_[robot];
    drive_changed_ = drive_changed_ || hold.driven;
    hold = {writer, now, false, false, order, seq_, 0};
    hold.order.robot_ids.clear();
    hold.order.num_robots = 0;
    given_back_.erase(robot);
  }
  return first;
}

Answer CommandArbiter::release(const std::vector<std::int32_t>& robots, dds::WriterId writer,
                               std::int64_t now) {
  Answer first = Answer::kTaken;
  for (const std::int32_t robot : robots) {
    const Answer answer = refusal(robot, writer, now);
    if (answer == Answer::kTaken) {
      giveBack(robot);
    } else if (first == Answer::kTaken) {
      first = answer;
    }
  }
  return first;
}

void CommandArbiter::giveBack(std::int32_t robot) {
  const auto hold = holds_.find(robot);
  if (hold == holds_.end()) return;
  drive_changed_ = drive_changed_ || hold->second.driven;
  holds_.erase(hold);
  given_back_.insert(robot);
}

void CommandArbiter::take(const robot_command_t& command, std::int64_t now) {
  for (const robot_order_t& order : command.orders) {
    for (const std::int32_t robot : order.robot_ids) {
      if (!robots_.contains(robot)) continue;
      lab_[robot] = {order.mode, now};
      // No release is sent: it would override the lab's command that has just arrived.
      if (order.mode != robot_order_t::TABLE) holds_.erase(robot);
    }
  }
}

void CommandArbiter::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    if (!robots_.contains(state.robot_id)) continue;
    if ((state.flags & robot_state_t::FLAG_STOPPED) != 0) {
      latched_.insert(state.robot_id);
      holds_.erase(state.robot_id);
    } else {
      latched_.erase(state.robot_id);
    }
  }
}

void CommandArbiter::take(const robot_stop_t& stop, std::int64_t now) {
  const std::set<std::int32_t> named(stop.robot_ids.begin(), stop.robot_ids.end());
  for (const std::int32_t robot : robots_) {
    if (!named.empty() && !named.contains(robot)) continue;
    if (stop.clear != 0) {
      stop_utime_.erase(robot);
    } else {
      stop_utime_[robot] = now;
      holds_.erase(robot);
    }
  }
}

void CommandArbiter::tick(std::int64_t now) {
  std::vector<std::int32_t> over;
  for (auto& [robot, hold] : holds_) {
    if (!hold.driven) continue;
    const std::int64_t silence = now - hold.heard_utime;
    if (silence > timeout_us_ && !hold.silent) {
      hold.silent = true;
      hold.order = {};
      hold.order.mode = robot_order_t::STAND;
      drive_changed_ = true;
      ++silences_;
    }
    if (silence > timeout_us_ + kGiveBack_us) over.push_back(robot);
  }
  for (const std::int32_t robot : over) giveBack(robot);
}

std::vector<robot_command_t> CommandArbiter::due(std::int64_t now) {
  std::vector<robot_command_t> out;
  if (!given_back_.empty()) {
    robot_command_t last{};
    last.seq = ++seq_;
    last.lease_ms = kEndLease_ms;
    robot_order_t stand{};
    stand.mode = robot_order_t::STAND;
    for (const std::int32_t robot : given_back_) add(stand, robot);
    add(last, std::move(stand));
    out.push_back(std::move(last));
    given_back_.clear();
  }
  driveMessage(now, out);
  orderMessages(now, out);
  return out;
}

void CommandArbiter::driveMessage(std::int64_t now, std::vector<robot_command_t>& out) {
  const std::int64_t since = now - drive_sent_utime_;
  const bool due = since >= kDriveRepeat_us || (drive_changed_ && since >= kDriveSpacing_us);
  if (!due) return;
  robot_command_t command{};
  command.lease_ms = kDriveLease_ms;
  for (const auto& [robot, hold] : holds_) {
    if (!hold.driven) continue;
    const auto same = std::find_if(
        command.orders.begin(), command.orders.end(),
        [&hold = hold](const robot_order_t& other) { return sameWheels(other, hold.order); });
    if (same != command.orders.end()) {
      add(*same, robot);
    } else {
      add(command, hold.order);
      add(command.orders.back(), robot);
    }
  }
  if (drive_changed_) drive_seq_ = ++seq_;
  drive_changed_ = false;
  if (command.orders.empty()) return;
  command.seq = drive_seq_;
  drive_sent_utime_ = now;
  out.push_back(std::move(command));
}

void CommandArbiter::orderMessages(std::int64_t now, std::vector<robot_command_t>& out) {
  std::map<std::int64_t, robot_command_t> by_seq;
  for (auto& [robot, hold] : holds_) {
    if (hold.driven) continue;
    const auto message = by_seq.find(hold.seq);
    if (message != by_seq.end()) {
      add(message->second.orders.front(), robot);
    } else if (now - hold.sent_utime >= kOrderRepeat_us && by_seq.size() < kMostOrdersATick) {
      robot_command_t command{};
      command.seq = hold.seq;
      command.lease_ms = kOrderLease_ms;
      add(command, hold.order);
      add(command.orders.front(), robot);
      by_seq.emplace(hold.seq, std::move(command));
    } else {
      continue;
    }
    hold.sent_utime = now;
  }
  for (auto& [seq, command] : by_seq) out.push_back(std::move(command));
}

}  // namespace lab::gateway
