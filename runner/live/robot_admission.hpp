/// Which robot ids of the bus the runner keeps state for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <lab/robot_command_t.hpp>
#include <optional>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// The robots of the experiment, and the first others that are heard of, up to a bound: any program
/// can publish any number of ids.
class RobotAdmission {
 public:
  /// @param most_others robots that are not of the experiment
  RobotAdmission(const Experiment& experiment, std::size_t most_others)
      : most_others_(most_others) {
    for (const RobotSpec& robot : experiment.robots) own_.insert(robot.id);
  }

  [[nodiscard]] bool admits(std::int32_t robot_id) {
    if (own_.contains(robot_id) || others_.contains(robot_id)) return true;
    if (others_.size() < most_others_) return others_.insert(robot_id).second;
    refused_ = true;
    return false;
  }

  /// The message without the robots that are refused; nothing if none is.
  template <typename Message>
  [[nodiscard]] std::optional<Message> withoutRefused(const Message& message) {
    const auto is_refused = [this](const auto& robot) { return !admits(robot.robot_id); };
    if (std::ranges::none_of(message.robots, is_refused)) return std::nullopt;
    Message admitted = message;
    std::erase_if(admitted.robots, is_refused);
    admitted.num_robots = static_cast<std::int32_t>(admitted.robots.size());
    return admitted;
  }

  /// The command without the ids that are refused.
  [[nodiscard]] robot_command_t admitted(robot_command_t command) {
    for (robot_order_t& order : command.orders) {
      std::erase_if(order.robot_ids, [this](std::int32_t id) { return !admits(id); });
    }
    return command;
  }

  /// Whether any id was refused.
  [[nodiscard]] bool refused() const { return refused_; }

  [[nodiscard]] std::size_t mostOthers() const { return most_others_; }

 private:
  std::size_t most_others_;
  std::set<std::int32_t> own_;
  std::set<std::int32_t> others_;
  bool refused_ = false;
};

}  // namespace lab::runner
