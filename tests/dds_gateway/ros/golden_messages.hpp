/// One sample of each message, and its bytes, computed by hand.
#pragma once

#include <cstdint>
#include <vector>

#include "dds_gateway/ros/ros_type.hpp"

namespace lab::ros {

struct GoldenMessage {
  const RosType* type;
  const void* sample;                 ///< of the type's C struct, lives as long as the program
  std::vector<std::uint8_t> payload;  ///< encapsulation header first
};

[[nodiscard]] std::vector<GoldenMessage> goldenMessages();

}  // namespace lab::ros
