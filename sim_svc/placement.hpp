/// Initial poses of the robots.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// One robot to be placed, with its given pose, or empty for a random one.
struct Place {
  std::int32_t id = 0;
  std::optional<dynamics::Pose> given;
};

/// Poses without overlap for disks of the given radius, in the order of `places`. Each robot
/// without a given pose tries random poses from its own random stream until one is free, so adding
/// a robot at the end does not move the others. It keeps 5 cm from the walls while there is room.
/// If that fails (above about half of the area
/// covered), all robots without a given pose are put on a hexagonal lattice and moved at random.
/// @throws std::invalid_argument naming the robots, if given poses overlap or lie outside, if an id
///         occurs twice, or if there is no room
[[nodiscard]] std::vector<dynamics::Pose> placeRobots(const std::vector<Place>& places,
                                                      const Arena& arena, double radius,
                                                      std::uint64_t seed);

}  // namespace lab::sim
