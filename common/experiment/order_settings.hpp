/// Orders on the bus, as settings of a robot's core.
#pragma once

#include <lab/program_t.hpp>
#include <lab/robot_order_t.hpp>
#include <string>
#include <vector>

#include "robot/dynamics/robot_core.hpp"
#include "robot/dynamics/robot_program.hpp"

namespace lab {

/// What an order makes of a robot.
struct OrderSettings {
  dynamics::CoreSettings core;
  std::vector<program_t> programs;  ///< by slot, as ordered
  std::string refusal;              ///< not empty: the robot cannot do this, and why
};

/// An order with another mode than TABLE has no programs, and its other parts are not looked at.
[[nodiscard]] OrderSettings settingsFrom(const robot_order_t& order,
                                         const dynamics::WheelLimits& limits, double sensor_period);

}  // namespace lab
