/// The lab's message types as types of ROS 2, for files that ROS 2's tools read.
///
/// robot_status_t becomes active_lab_bus/msg/RobotStatus, with the same fields in the same order,
/// their units and constants. A list is a sequence; the field that counts it is kept as well.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/schema/schema.hpp"

namespace lab::schema {

inline constexpr const char* kRosPackage = "active_lab_bus";

/// "active_lab_bus/msg/RobotStatus"
[[nodiscard]] std::string rosName(const Type& type);

/// The type with this name; nullptr: there is none.
[[nodiscard]] const Type* typeOfRosName(std::string_view name);

/// The definition in the form "ros2msg" of MCAP: the .msg file, and those of the types in it.
[[nodiscard]] std::string rosDefinition(const Type& type);

/// Converts LCM's encoding to CDR.
/// @return nothing if `encoding` is none of the type
[[nodiscard]] std::optional<std::vector<std::uint8_t>> toCdr(const Type& type, Bytes encoding);

/// Converts CDR, of either byte order, to LCM's encoding: the inverse of toCdr().
/// @return nothing if `cdr` is no message of the type, or a count differs from the length of its
///   list
[[nodiscard]] std::optional<std::vector<std::uint8_t>> fromCdr(const Type& type, Bytes cdr);

}  // namespace lab::schema
