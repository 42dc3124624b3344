/// Converts orders on the bus to settings of a robot's core.
#pragma once

#include <cstdint>
#include <lab/program_t.hpp>
#include <lab/robot_order_t.hpp>
#include <string>
#include <vector>

#include "robot/dynamics/robot_core.hpp"
#include "robot/dynamics/wheel_limits.hpp"

namespace lab {

/// The settings that a robot needs for an order.
struct OrderSettings {
  dynamics::CoreSettings core;  ///< without the robot's id
  std::vector<program_t>
      programs;         ///< by slot: id and valid byte code, without text and parameters
  std::string refusal;  ///< why the robot cannot execute the order; empty if it can
};

/// Converts and checks an order. An order with another mode than TABLE has no programs, and its
/// other parts are not checked.
/// @param sensor_period [s]
[[nodiscard]] OrderSettings settingsFrom(const robot_order_t& order,
                                         const dynamics::WheelLimits& limits, double sensor_period);

/// What a robot must keep of an order until it can be converted: the same settings and the same
/// refusals, in at most 500 kB. Of what is too long, only one byte too many is left.
/// @param robot_id the robot, which is the only one that the result names
[[nodiscard]] robot_order_t orderToKeep(const robot_order_t& order, std::int32_t robot_id);

}  // namespace lab
