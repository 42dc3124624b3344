// What the simulated robots measure.
#include <algorithm>
#include <cmath>

#include "sim_svc/world.hpp"
#include "sim_svc/world/ir_scan.hpp"

namespace lab::sim {
namespace {

constexpr double kFullScale = 1023;

void copyCounts(const IrScan& ir, dynamics::Sensors& sensors) {
  const auto counts = ir.counts();
  std::copy(counts.begin(), counts.end(), sensors.ir);
}

std::uint16_t withNoise(std::uint16_t counts, double noise) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(counts + noise, 0.0, kFullScale)));
}

}  // namespace

dynamics::Sensors World::measure(std::size_t i) const {
  dynamics::Sensors sensors;
  senseLight(i, sensors);
  IrScan ir(centres_[i], bodies_[i].heading, settings_.radius, settings_.ir_range);
  ir.addWalls(settings_.arena);
  addRobots(i, ir);
  copyCounts(ir, sensors);
  return sensors;
}

// One scan at the robot's present time, handed to its core.
void World::scan(std::size_t i) {
  Electronics& robot = electronics_[i];
  robot.last_scan_ms = robot.next_scan_ms;
  robot.next_scan_ms += std::max<std::int64_t>(1, robot.core.settings().sensor_period_ms);

  dynamics::Sensors for_core;
  senseLight(i, for_core);
  if (settings_.light_noise > 0) {
    for_core.light_front =
        withNoise(for_core.light_front, settings_.light_noise * robot.light_noise.normal());
    for_core.light_back =
        withNoise(for_core.light_back, settings_.light_noise * robot.light_noise.normal());
  }
  IrScan ir(centres_[i], bodies_[i].heading, settings_.radius, settings_.ir_range);
  ir.addWalls(settings_.arena);
  copyCounts(ir, for_core);
  addRobots(i, ir);
  robot.sensors = for_core;
  copyCounts(ir, robot.sensors);
  robot.core.sense(static_cast<std::uint32_t>(robot.local_ms),
                   robot.sees_robots ? robot.sensors : for_core);
}

void World::senseLight(std::size_t i, dynamics::Sensors& sensors) const {
  const Vec centre = centres_[i];
  const Vec offset = {settings_.light_offset * bodies_[i].heading.x,
                      settings_.light_offset * bodies_[i].heading.y};
  const Electronics& robot = electronics_[i];
  sensors.light_front = lightCounts({centre.x + offset.x, centre.y + offset.y}, robot.front_gain);
  sensors.light_back = lightCounts({centre.x - offset.x, centre.y - offset.y}, robot.back_gain);
}

std::uint16_t World::lightCounts(Vec at, double gain) const {
  const double intensity = light_ == nullptr ? 0 : gain * light_->at(at.x, at.y);
  return static_cast<std::uint16_t>(std::lround(kFullScale * std::clamp(intensity, 0.0, 1.0)));
}

void World::addRobots(std::size_t i, IrScan& ir) const {
  const double reach = 2 * settings_.radius + settings_.ir_range;
  for (const std::uint32_t j : neighbours_.of(i)) {
    const Vec to_other = {centres_[j].x - centres_[i].x, centres_[j].y - centres_[i].y};
    if (to_other.x * to_other.x + to_other.y * to_other.y < reach * reach) {
      ir.addDisk(to_other);
    }
  }
}

}  // namespace lab::sim
