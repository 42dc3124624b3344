/// Robots at random poses in the arena without contact.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "sim_svc/camera_painter.hpp"

namespace lab::detector {

inline std::vector<sim::PaintedRobot> scatteredRobots(int count, std::uint64_t seed) {
  constexpr double kApart = 0.0755;  // [m] half a millimetre more than in contact
  std::vector<sim::PaintedRobot> robots;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> x(0.04, 1.16);
  std::uniform_real_distribution<double> y(0.04, 0.86);
  std::uniform_real_distribution<double> theta(-std::numbers::pi, std::numbers::pi);
  while (static_cast<int>(robots.size()) < count) {
    const sim::PaintedRobot robot{x(random), y(random), theta(random), 0, 0, 0};
    bool free = true;
    for (const sim::PaintedRobot& other : robots) {
      free = free && std::hypot(robot.x - other.x, robot.y - other.y) > kApart;
    }
    if (free) robots.push_back(robot);
  }
  return robots;
}

}  // namespace lab::detector
