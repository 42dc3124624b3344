/// Robots that the lab leaves to others for a while.
#pragma once

#include <algorithm>
#include <cstdint>
#include <lab/robot_command_t.hpp>
#include <map>
#include <utility>

namespace lab::runner {

/// The lab's light table yields: a robot that ROBOT_COMMAND of another sender has an order for is
/// that sender's while the order's lease runs. The lab's orders to stand and to drive do not yield.
/// Without this, two senders would be obeyed in turn.
class YieldedRobots {
 public:
  /// Nobody holds a robot longer without a word, whatever lease he writes.
  static constexpr std::int32_t kLongest_ms = 60'000;

  /// A command of another sender.
  void take(const robot_command_t& command, std::int64_t now) {
    const std::int64_t until =
        now + std::int64_t{std::clamp(command.lease_ms, 0, kLongest_ms)} * 1000;
    for (const robot_order_t& order : command.orders) {
      for (const std::int32_t id : order.robot_ids) until_utime_[id] = until;
    }
  }

  [[nodiscard]] bool contains(std::int32_t robot, std::int64_t now) const {
    const auto until = until_utime_.find(robot);
    return until != until_utime_.end() && now < until->second;
  }

  /// The lab's command without the robots that are others' now.
  [[nodiscard]] robot_command_t without(robot_command_t command, std::int64_t now) const {
    for (robot_order_t& order : command.orders) {
      if (order.mode != robot_order_t::TABLE) continue;
      std::erase_if(order.robot_ids, [&](std::int32_t id) { return contains(id, now); });
      order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
    }
    return command;
  }

 private:
  std::map<std::int32_t, std::int64_t> until_utime_;
};

}  // namespace lab::runner
