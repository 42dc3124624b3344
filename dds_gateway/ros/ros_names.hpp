/// Names of topics and frames in ROS 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lab::gateway {

/// Some rmw layers limit the length of the DDS name.
inline constexpr std::size_t kLongestTopicName = 200;

/// True if `name` is a valid full ROS 2 topic name: parts of [A-Za-z0-9_] after each "/", which do
/// not begin with a digit and do not contain "__", of at most kLongestTopicName characters.
[[nodiscard]] bool isTopicName(std::string_view name);

/// Makes one part of a name from any text. Each run of characters outside [A-Za-z0-9] becomes one
/// "_". A leading digit gets a "_" before it. An empty text becomes "_". Two texts may give the
/// same name.
[[nodiscard]] std::string namePart(std::string_view text);

/// "robot7"
[[nodiscard]] std::string robotName(std::int32_t id);

/// The names of one lab; `lab` is the key gateway.name of the experiment.
class RosNames {
 public:
  explicit RosNames(std::string_view lab) : lab_(namePart(lab)) {}

  /// "/lab/light_field"
  [[nodiscard]] std::string topic(std::string_view what) const;
  /// "/lab/robot7/pose"
  [[nodiscard]] std::string topic(std::int32_t robot, std::string_view what) const;

  /// Frame of the arena for tf: "lab/arena", origin at a corner, x along its width, z up (REP-103).
  [[nodiscard]] std::string arenaFrame() const { return lab_ + "/arena"; }
  /// Frame of a robot: "lab/robot7", x forward, origin midway between the wheels.
  [[nodiscard]] std::string robotFrame(std::int32_t robot) const {
    return lab_ + "/" + robotName(robot);
  }
  [[nodiscard]] const std::string& lab() const { return lab_; }

 private:
  std::string lab_;
};

}  // namespace lab::gateway
