/// The definitions of ROS 2's messages as .msg files, from messages.idl.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace lab::ros {

struct MsgField {
  std::string name;
  std::string type;  ///< as in .msg files: "float64", "geometry_msgs/Pose"
  bool sequence = false;
  int array = 0;  ///< length, 0: none
};

/// Messages by name: "geometry_msgs/msg/Pose".
using MsgDefinitions = std::map<std::string, std::vector<MsgField>>;

/// Reads an IDL file of the form of messages.idl.
/// @throws std::invalid_argument with the line that is not understood
[[nodiscard]] MsgDefinitions readIdl(const std::string& text);

/// The .msg file of a message of messages.idl, and those of the types in it (MCAP's "ros2msg").
/// @throws std::out_of_range if there is none of this name
[[nodiscard]] std::string msgDefinition(const std::string& name);

/// The text of messages.idl, embedded by the build.
[[nodiscard]] const std::string& messagesIdl();

}  // namespace lab::ros
