// Layers as the file says them and as the lab takes them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_values.hpp"
#include "light/field/layer.hpp"

namespace lab::keys {
namespace {

using light::LayerKind;

double phaseRate(double speed, double period) { return 2 * std::numbers::pi * speed / period; }

/// The speed, of those that a file can say, with the fewest digits that gives exactly this rate, so
/// that a file that is written and read again says the same.
double speedOf(double rate, double period) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const FileUnit& unit = unitOf("_cm_s");
  const double near = rate * period / (2 * std::numbers::pi);
  const double in_file = near * unit.divide / unit.multiply;
  for (const double start :
       {in_file, std::nextafter(in_file, -kInfinity), std::nextafter(in_file, kInfinity)}) {
    for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
      const double speed = toSi(roundedToDigits(start, digits), unit);
      if (phaseRate(speed, period) == rate) return speed;
    }
  }
  return near;
}

}  // namespace

std::optional<double> lightFor(const LightTable& table, const std::string& program) {
  const auto band = std::ranges::find(table.bands, program, &LightBand::program);
  if (band == table.bands.end()) return {};
  return 0.5 * (band->low + band->high);
}

LayerSpec toLayer(const LayerEntry& entry, const Experiment& common) {
  LayerSpec layer = entry.layer;
  const auto kind = static_cast<LayerKind>(layer.kind);
  if (kind != LayerKind::kUniform) {
    const bool in_robots_frame = layer.drive.follow == light::Follow::kRobots;
    layer.x = entry.x.value_or(in_robots_frame ? 0 : common.arena_width / 2);
    layer.y = entry.y.value_or(in_robots_frame ? 0 : common.arena_height / 2);
  }
  if (kind == LayerKind::kWave) layer.drive.phase_rate = phaseRate(entry.speed, layer.size);
  if (kind == LayerKind::kNoise) layer.drive.phase_rate = entry.change;
  if (!layer.drive.images.empty()) layer.image = layer.drive.images.front();
  if (!entry.program.empty()) {
    layer.intensity = lightFor(common.light_table, entry.program).value_or(0);
  }
  return layer;
}

LayerEntry toEntry(const LayerSpec& layer) {
  LayerEntry entry{.layer = layer, .x = layer.x, .y = layer.y};
  const auto kind = static_cast<LayerKind>(layer.kind);
  if (kind == LayerKind::kWave) entry.speed = speedOf(layer.drive.phase_rate, layer.size);
  if (kind == LayerKind::kNoise) entry.change = layer.drive.phase_rate;
  return entry;
}

}  // namespace lab::keys
