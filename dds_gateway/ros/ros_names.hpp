/// What things are called in ROS 2.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lab::gateway {

/// Whether ROS 2 takes it as the full name of a topic: "/" and parts of [A-Za-z0-9_] that begin
/// with no digit, without "__"; at most 200 characters, so that DDS's name of it is short enough
/// for every rmw layer.
[[nodiscard]] bool isTopicName(std::string_view name);

/// One part of a name out of any text: other characters become "_", runs of them one, a digit in
/// front gets an "_" before it, nothing becomes "_". Two texts may become the same name.
[[nodiscard]] std::string namePart(std::string_view text);

/// "robot7"
[[nodiscard]] std::string robotName(std::int32_t id);

/// The names of one lab; `lab` is Gateway::name.
class RosNames {
 public:
  explicit RosNames(std::string_view lab) : lab_(namePart(lab)) {}

  /// "/lab/light_field"
  [[nodiscard]] std::string topic(std::string_view what) const;
  /// "/lab/robot7/pose"
  [[nodiscard]] std::string topic(std::int32_t robot, std::string_view what) const;

  /// tf's name of the arena: origin at a corner, x along its width, z up (REP-103): "lab/arena"
  [[nodiscard]] std::string arenaFrame() const { return lab_ + "/arena"; }
  /// x forward, origin midway between the wheels: "lab/robot7"
  [[nodiscard]] std::string robotFrame(std::int32_t robot) const {
    return lab_ + "/" + robotName(robot);
  }
  [[nodiscard]] const std::string& lab() const { return lab_; }

 private:
  std::string lab_;
};

}  // namespace lab::gateway
