/// Where the robots stand when the simulation begins.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// One robot to be placed: where it was asked to stand, or anywhere.
struct Place {
  std::int32_t id = 0;
  std::optional<dynamics::Pose> given;
};

/// Poses without overlap for disks of the given radius, in the order of `places`. Where none is
/// given, it is random: each robot tries places of its own random stream until one is free, so that
/// a robot added at the end moves no other. When that finds no place (above about half of the area
/// covered), all robots without a given pose are put on a hexagonal lattice and shaken.
/// @throws std::invalid_argument naming the robots, when given poses overlap or lie outside, when
/// an
///         id occurs twice, or when there is no room
[[nodiscard]] std::vector<dynamics::Pose> placeRobots(const std::vector<Place>& places,
                                                      const Arena& arena, double radius,
                                                      std::uint64_t seed);

}  // namespace lab::sim
