#include "sim_svc/world/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lab::sim {
namespace {

constexpr double kFullScale = 1023;

void copyCounts(const IrScan& ir, dynamics::Sensors& sensors) {
  const auto counts = ir.counts();
  std::copy(counts.begin(), counts.end(), sensors.ir);
}

std::uint16_t lightCounts(double intensity, double gain) {
  return roundedCounts(kFullScale * std::clamp(gain * intensity, 0.0, 1.0));
}

std::uint16_t withNoise(std::uint16_t counts, double noise) {
  return roundedCounts(std::clamp(counts + noise, 0.0, kFullScale));
}

}  // namespace

dynamics::Sensors SensorModel::measure(const DiskArena& disks, std::size_t i,
                                       const LightGains& gains) const {
  const auto [front, back] = lightPlaces(disks, i);
  const std::array<double, 2> x = {front.x, back.x};
  const std::array<double, 2> y = {front.y, back.y};
  std::array<double, 2> light{};
  lightAt(x.data(), y.data(), 2, light.data());
  SensorScan scan;
  senseLight(gains, light[0], light[1], scan.all);
  senseObstacles(disks, i, scan);
  return scan.all;
}

std::array<Vec, 2> SensorModel::lightPlaces(const DiskArena& disks, std::size_t i) const {
  const Vec centre = disks.centre(i);
  const Vec heading = disks.heading(i);
  const Vec offset = {settings_.light_offset * heading.x, settings_.light_offset * heading.y};
  return {Vec{centre.x + offset.x, centre.y + offset.y},
          Vec{centre.x - offset.x, centre.y - offset.y}};
}

void SensorModel::lightAt(const double* x, const double* y, std::size_t count, double* out) const {
  if (light_ == nullptr) {
    std::fill_n(out, count, 0.0);
  } else {
    light_->atPlaces(x, y, count, out);
  }
}

SensorScan SensorModel::scan(const DiskArena& disks, std::size_t i, const LightGains& gains,
                             double front, double back, Random& light_noise) const {
  SensorScan scan;
  dynamics::Sensors& sensors = scan.all;
  senseLight(gains, front, back, sensors);
  if (settings_.light_noise > 0) {
    sensors.light_front =
        withNoise(sensors.light_front, settings_.light_noise * light_noise.normal());
    sensors.light_back =
        withNoise(sensors.light_back, settings_.light_noise * light_noise.normal());
  }
  scan.walls_only = sensors;
  senseObstacles(disks, i, scan);
  return scan;
}

void SensorModel::senseLight(const LightGains& gains, double front, double back,
                             dynamics::Sensors& sensors) const {
  sensors.light_front = lightCounts(front, gains.front);
  sensors.light_back = lightCounts(back, gains.back);
}

// Most robots have nothing in range; their readings stay 0.
void SensorModel::senseObstacles(const DiskArena& disks, std::size_t i, SensorScan& scan) const {
  const Vec centre = disks.centre(i);
  const Arena& arena = disks.arena();
  const double to_wall = std::min(std::min(centre.x, arena.width - centre.x),
                                  std::min(centre.y, arena.height - centre.y));
  const double reach = 2 * settings_.radius + settings_.ir_range;
  std::optional<IrScan> ir;
  if (to_wall < settings_.radius + settings_.ir_range) {
    ir.emplace(centre, disks.heading(i), settings_.radius, settings_.ir_range);
    ir->addWalls(arena);
    copyCounts(*ir, scan.walls_only);
  }
  for (const std::uint32_t j : disks.neighbours(i)) {
    const Vec other = disks.seen(j);
    const Vec to_other = {other.x - centre.x, other.y - centre.y};
    if (to_other.x * to_other.x + to_other.y * to_other.y >= reach * reach) continue;
    if (!ir) ir.emplace(centre, disks.heading(i), settings_.radius, settings_.ir_range);
    ir->addDisk(to_other);
  }
  if (ir) copyCounts(*ir, scan.all);
}

}  // namespace lab::sim
