#include "common/experiment/light_messages.hpp"

#include <memory>
#include <stdexcept>

#include "common/files/image_file.hpp"

namespace lab {
namespace {

using light::Blend;
using light::LayerKind;

// light_layer_t and light::Layer use the same numbers for kinds and blends.
static_assert(light_layer_t::UNIFORM == static_cast<int>(LayerKind::kUniform));
static_assert(light_layer_t::HALF_PLANE == static_cast<int>(LayerKind::kHalfPlane));
static_assert(light_layer_t::DISK == static_cast<int>(LayerKind::kDisk));
static_assert(light_layer_t::RING == static_cast<int>(LayerKind::kRing));
static_assert(light_layer_t::LINEAR_GRADIENT == static_cast<int>(LayerKind::kLinearGradient));
static_assert(light_layer_t::RADIAL_GRADIENT == static_cast<int>(LayerKind::kRadialGradient));
static_assert(light_layer_t::STRIPES == static_cast<int>(LayerKind::kStripes));
static_assert(light_layer_t::CHECKER == static_cast<int>(LayerKind::kChecker));
static_assert(light_layer_t::IMAGE == static_cast<int>(LayerKind::kImage));
static_assert(light_layer_t::FADE == static_cast<int>(LayerKind::kFade));
static_assert(light_layer_t::NOISE == static_cast<int>(LayerKind::kNoise));
static_assert(light_layer_t::WAVE == static_cast<int>(LayerKind::kWave));
static_assert(light_layer_t::GRID == static_cast<int>(LayerKind::kGrid));
static_assert(light_layer_t::OVER == static_cast<int>(Blend::kOver));
static_assert(light_layer_t::ADD == static_cast<int>(Blend::kAdd));
static_assert(light_layer_t::MULTIPLY == static_cast<int>(Blend::kMultiply));
static_assert(light_layer_t::MAX == static_cast<int>(Blend::kMax));
static_assert(light_layer_t::MIN == static_cast<int>(Blend::kMin));
static_assert(light_drive_t::TELEGRAPH == static_cast<int>(light::Waveform::kTelegraph));
static_assert(light_drive_t::TRAIL == static_cast<int>(light::Follow::kTrail));
static_assert(light_drive_t::SAFE == static_cast<int>(light::WhenLost::kSafe));
static_assert(light_drive_t::OUTSIDE == static_cast<int>(light::Gate::kOutside));

light::Layer toLayer(const light_layer_t& message) {
  light::Layer layer;
  layer.kind = static_cast<LayerKind>(message.kind);
  layer.blend = static_cast<Blend>(message.blend);
  layer.x = message.x;
  layer.y = message.y;
  layer.angle = message.angle;
  layer.size = message.size;
  layer.inner = message.inner;
  layer.softness = message.softness;
  layer.intensity = message.intensity;
  layer.intensity2 = message.intensity2;
  layer.image = message.image;
  layer.seed = static_cast<std::uint64_t>(message.seed);
  layer.phase = message.phase;
  if (layer.kind == LayerKind::kGrid) {
    auto pixels = std::make_shared<light::Image>();
    pixels->columns = message.columns;
    pixels->rows = message.rows;
    pixels->grey = message.grid;
    layer.pixels = std::move(pixels);
  }
  return layer;
}

light::Drive toDrive(const light_drive_t& message) {
  light::Drive drive;
  drive.vx = message.vx;
  drive.vy = message.vy;
  drive.spin = message.spin;
  drive.phase_rate = message.phase_rate;
  drive.waveform = static_cast<light::Waveform>(message.waveform);
  drive.period = message.period;
  drive.low = message.low;
  drive.start = message.start;
  drive.seed = static_cast<std::uint64_t>(message.seed);
  drive.image_rate = message.image_rate;
  drive.image_loop = message.image_loop != 0;
  drive.images = message.images;
  drive.follow = static_cast<light::Follow>(message.follow);
  drive.robots = message.robots;
  drive.predict = message.predict != 0;
  drive.stale = message.stale;
  drive.when_lost = static_cast<light::WhenLost>(message.when_lost);
  drive.rate = message.rate;
  drive.decay = message.decay;
  drive.diffusion = message.diffusion;
  drive.gate = static_cast<light::Gate>(message.gate);
  drive.gate_robot = message.gate_robot;
  drive.gate_program = message.gate_program;
  drive.gate_x = message.gate_x;
  drive.gate_y = message.gate_y;
  drive.gate_radius = message.gate_radius;
  return drive;
}

}  // namespace

light::Layer toLightLayer(const LayerSpec& layer) {
  light::Layer result;
  result.kind = static_cast<light::LayerKind>(layer.kind);
  result.blend = static_cast<light::Blend>(layer.blend);
  result.x = layer.x;
  result.y = layer.y;
  result.angle = layer.angle;
  result.size = layer.size;
  result.inner = layer.inner;
  result.softness = layer.softness;
  result.intensity = layer.intensity;
  result.intensity2 = layer.intensity2;
  result.seed = layer.seed;
  result.phase = layer.phase;
  return result;
}

light_layer_t toMessage(const light::Layer& layer) {
  light_layer_t message{};
  message.kind = static_cast<std::int8_t>(layer.kind);
  message.blend = static_cast<std::int8_t>(layer.blend);
  message.x = layer.x;
  message.y = layer.y;
  message.angle = layer.angle;
  message.size = layer.size;
  message.inner = layer.inner;
  message.softness = layer.softness;
  message.intensity = layer.intensity;
  message.intensity2 = layer.intensity2;
  message.image = layer.image;
  message.seed = static_cast<std::int64_t>(layer.seed);
  message.phase = layer.phase;
  if (layer.kind == LayerKind::kGrid && layer.pixels) {
    message.columns = layer.pixels->columns;
    message.rows = layer.pixels->rows;
    message.grid = layer.pixels->grey;
    message.num_grid = static_cast<std::int32_t>(message.grid.size());
  }
  return message;
}

light_drive_t toMessage(const light::Drive& drive, std::int32_t layer) {
  light_drive_t message{};
  message.layer = layer;
  message.vx = drive.vx;
  message.vy = drive.vy;
  message.spin = drive.spin;
  message.phase_rate = drive.phase_rate;
  message.waveform = static_cast<std::int8_t>(drive.waveform);
  message.period = drive.period;
  message.low = drive.low;
  message.start = drive.start;
  message.seed = static_cast<std::int64_t>(drive.seed);
  message.image_rate = drive.image_rate;
  message.image_loop = drive.image_loop ? 1 : 0;
  message.images = drive.images;
  message.num_images = static_cast<std::int32_t>(message.images.size());
  message.follow = static_cast<std::int8_t>(drive.follow);
  message.robots = drive.robots;
  message.num_robots = static_cast<std::int32_t>(message.robots.size());
  message.predict = drive.predict ? 1 : 0;
  message.stale = drive.stale;
  message.when_lost = static_cast<std::int8_t>(drive.when_lost);
  message.rate = drive.rate;
  message.decay = drive.decay;
  message.diffusion = drive.diffusion;
  message.gate = static_cast<std::int8_t>(drive.gate);
  message.gate_robot = drive.gate_robot;
  message.gate_program = drive.gate_program;
  message.gate_x = drive.gate_x;
  message.gate_y = drive.gate_y;
  message.gate_radius = drive.gate_radius;
  return message;
}

void setLayers(light_command_t& command, const std::vector<light::DrivenLayer>& layers) {
  command.layers.clear();
  command.drives.clear();
  for (const light::DrivenLayer& layer : layers) {
    if (!light::isStill(layer.drive)) {
      command.drives.push_back(
          toMessage(layer.drive, static_cast<std::int32_t>(command.layers.size())));
    }
    command.layers.push_back(toMessage(layer.layer));
  }
  command.num_layers = static_cast<std::int32_t>(command.layers.size());
  command.num_drives = static_cast<std::int32_t>(command.drives.size());
}

std::vector<light::DrivenLayer> toDrivenLayers(const light_command_t& command,
                                               const light::ImageStore& images) {
  std::vector<light::DrivenLayer> layers;
  for (light::Layer& layer : toLayers(command.layers, images)) {
    layers.push_back({std::move(layer), {}});
  }
  for (const light_drive_t& drive : command.drives) {
    const auto index = static_cast<std::size_t>(drive.layer);
    if (drive.layer >= 0 && index < layers.size()) layers[index].drive = toDrive(drive);
  }
  return layers;
}

std::vector<light_layer_t> toMessages(const std::vector<light::Layer>& layers) {
  std::vector<light_layer_t> messages;
  messages.reserve(layers.size());
  for (const light::Layer& layer : layers) messages.push_back(toMessage(layer));
  return messages;
}

std::vector<light::Layer> toLayers(const std::vector<light_layer_t>& layers,
                                   const light::ImageStore& images) {
  std::vector<light::Layer> out;
  out.reserve(layers.size());
  for (const light_layer_t& layer : layers) out.push_back(toLayer(layer));
  light::attachImages(out, images);
  return out;
}

light::Field toField(const std::vector<light_layer_t>& layers, const light::ImageStore& images) {
  return {toLayers(layers, images), {}, 1};
}

light::Field toField(const light_status_t& status, const light::ImageStore& images) {
  return {toLayers(status.layers, images), toLayers(status.previous, images), status.mix};
}

ExperimentImages loadImages(const Experiment& experiment, const std::filesystem::path& directory) {
  ExperimentImages images;
  ImageFiles files;
  const auto load = [&](const std::string& name) {
    if (name.empty() || images.digests.contains(name)) return;
    const light::DecodedImage& loaded = files.at(directory / name);
    if (!loaded.image) throw std::runtime_error(loaded.error);
    images.digests[name] = loaded.image->sha256;
    images.store[loaded.image->sha256] = loaded.image;
  };
  for (const LightStep& step : experiment.light.steps) {
    for (const LayerSpec& layer : step.layers) {
      load(layer.image);
      for (const std::string& name : layer.drive.images) load(name);
    }
  }
  return images;
}

std::vector<light::DrivenLayer> toDrivenLayers(const std::vector<LayerSpec>& layers,
                                               const ExperimentImages& images) {
  std::vector<light::DrivenLayer> driven;
  for (const LayerSpec& spec : layers) {
    light::DrivenLayer& layer =
        driven.emplace_back(light::DrivenLayer{toLightLayer(spec), spec.drive});
    if (!spec.image.empty()) {
      layer.layer.image = images.digests.at(spec.image);
      layer.layer.pixels = images.store.at(layer.layer.image);
    }
    for (std::string& name : layer.drive.images) name = images.digests.at(name);
  }
  return driven;
}

std::string formatRefusal(const std::string& sender, std::int64_t seq, const std::string& reason) {
  return "LIGHT_COMMAND " + std::to_string(seq) + " of " + sender + ": " + reason;
}

std::string parseRefusal(const std::string& sender, std::int64_t seq,
                         const std::string& last_refusal) {
  const std::string ours = formatRefusal(sender, seq, "");
  return last_refusal.starts_with(ours) ? last_refusal.substr(ours.size()) : std::string();
}

}  // namespace lab
