/// RIHS01, the hash by which ROS 2 names a message's definition (REP 2016), from that definition.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace lab::ros {

struct Field {
  std::string name;
  std::string type;  ///< as .msg files name it: "float64", "geometry_msgs/msg/Pose"
  bool sequence = false;
  int array = 0;  ///< length, 0: none

  bool operator==(const Field&) const = default;
};

/// Messages by name: "geometry_msgs/msg/Pose".
using Definitions = std::map<std::string, std::vector<Field>>;

/// Of messages.idl: modules, structs, members, annotations and comments, nothing else.
/// @throws std::runtime_error with what was not understood.
[[nodiscard]] Definitions fromIdl(const std::string& text);

/// Of one .msg file. Constants and comments do not count.
[[nodiscard]] std::vector<Field> fromMsg(const std::string& text, const std::string& package);

/// "RIHS01_...".
/// @throws std::out_of_range when the definitions lack a message.
[[nodiscard]] std::string typeHash(const Definitions& definitions, const std::string& message);

}  // namespace lab::ros
