#include "common/light_messages.hpp"

#include <stdexcept>

namespace lab {
namespace {

using light::Blend;
using light::LayerKind;

// The contract and the core number kinds and blends alike.
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
static_assert(light_layer_t::OVER == static_cast<int>(Blend::kOver));
static_assert(light_layer_t::ADD == static_cast<int>(Blend::kAdd));
static_assert(light_layer_t::MULTIPLY == static_cast<int>(Blend::kMultiply));
static_assert(light_layer_t::MAX == static_cast<int>(Blend::kMax));
static_assert(light_layer_t::MIN == static_cast<int>(Blend::kMin));

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
  return layer;
}

}  // namespace

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
  return message;
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
  for (const LightStep& step : experiment.light.steps) {
    for (const LayerSpec& layer : step.layers) {
      if (layer.image.empty() || images.digests.contains(layer.image)) continue;
      const light::DecodedImage loaded = light::loadImage(directory / layer.image);
      if (!loaded.image) throw std::runtime_error(loaded.error);
      images.digests[layer.image] = loaded.image->sha256;
      images.store[loaded.image->sha256] = loaded.image;
    }
  }
  return images;
}

}  // namespace lab
