/// Computes RIHS01, ROS 2's hash of a message definition (REP 2016), from the definition.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace lab::ros {

struct Field {
  std::string name;
  std::string type;  ///< as named in .msg files: "float64", "geometry_msgs/msg/Pose"
  bool sequence = false;
  int array = 0;  ///< length, 0: none

  bool operator==(const Field&) const = default;
};

/// Messages by name: "geometry_msgs/msg/Pose".
using Definitions = std::map<std::string, std::vector<Field>>;

/// Reads messages.idl: modules, structs, members, annotations and comments, nothing else.
/// @throws std::runtime_error with the text that was not understood
[[nodiscard]] Definitions fromIdl(const std::string& text);

/// Reads one .msg file. Constants and comments do not count.
[[nodiscard]] std::vector<Field> fromMsg(const std::string& text, const std::string& package);

/// "RIHS01_...".
/// @throws std::out_of_range if the definitions lack a message
[[nodiscard]] std::string typeHash(const Definitions& definitions, const std::string& message);

}  // namespace lab::ros
