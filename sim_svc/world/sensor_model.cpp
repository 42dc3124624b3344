#include "sim_svc/world/sensor_model.hpp"

#include <algorithm>
#include <cmath>

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

dynamics::Sensors SensorModel::measure(const DiskArena& disks, std::size_t i,
                                       const LightGains& gains) const {
  dynamics::Sensors sensors;
  senseLight(disks, i, gains, sensors);
  IrScan ir = scanWalls(disks, i);
  addRobots(disks, i, ir);
  copyCounts(ir, sensors);
  return sensors;
}

SensorScan SensorModel::scan(const DiskArena& disks, std::size_t i, const LightGains& gains,
                             Random& light_noise) const {
  SensorScan scan;
  dynamics::Sensors& sensors = scan.walls_only;
  senseLight(disks, i, gains, sensors);
  if (settings_.light_noise > 0) {
    sensors.light_front =
        withNoise(sensors.light_front, settings_.light_noise * light_noise.normal());
    sensors.light_back =
        withNoise(sensors.light_back, settings_.light_noise * light_noise.normal());
  }
  IrScan ir = scanWalls(disks, i);
  copyCounts(ir, sensors);
  addRobots(disks, i, ir);
  scan.all = sensors;
  copyCounts(ir, scan.all);
  return scan;
}

void SensorModel::senseLight(const DiskArena& disks, std::size_t i, const LightGains& gains,
                             dynamics::Sensors& sensors) const {
  const Vec centre = disks.centre(i);
  const Vec heading = disks.heading(i);
  const Vec offset = {settings_.light_offset * heading.x, settings_.light_offset * heading.y};
  sensors.light_front = lightCounts({centre.x + offset.x, centre.y + offset.y}, gains.front);
  sensors.light_back = lightCounts({centre.x - offset.x, centre.y - offset.y}, gains.back);
}

std::uint16_t SensorModel::lightCounts(Vec at, double gain) const {
  const double intensity = light_ == nullptr ? 0 : gain * light_->at(at.x, at.y);
  return static_cast<std::uint16_t>(std::lround(kFullScale * std::clamp(intensity, 0.0, 1.0)));
}

IrScan SensorModel::scanWalls(const DiskArena& disks, std::size_t i) const {
  IrScan ir(disks.centre(i), disks.heading(i), settings_.radius, settings_.ir_range);
  ir.addWalls(disks.arena());
  return ir;
}

void SensorModel::addRobots(const DiskArena& disks, std::size_t i, IrScan& ir) const {
  const double reach = 2 * settings_.radius + settings_.ir_range;
  const Vec centre = disks.centre(i);
  for (const std::uint32_t j : disks.neighbours(i)) {
    const Vec other = disks.seen(j);
    const Vec to_other = {other.x - centre.x, other.y - centre.y};
    if (to_other.x * to_other.x + to_other.y * to_other.y < reach * reach) {
      ir.addDisk(to_other);
    }
  }
}

}  // namespace lab::sim
