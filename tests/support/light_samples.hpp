/// Sample layers for tests of the light field.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "light/field/field.hpp"
#include "light/field/image.hpp"

namespace lab::light {

/// A grey image named by the hash of its pixels; needs no file.
inline std::shared_ptr<const Image> makeImage(int columns, int rows,
                                              std::vector<std::uint8_t> grey) {
  auto image = std::make_shared<Image>();
  image->columns = columns;
  image->rows = rows;
  image->grey = std::move(grey);
  image->sha256 = sha256(image->grey);
  return image;
}

/// One valid layer of every kind that draws, rotated, softened and off centre.
inline std::vector<Layer> oneOfEachKind() {
  const auto image = makeImage(2, 2, {0, 255, 128, 64});
  Layer base{.x = 0.5, .y = 0.4, .angle = 0.7, .size = 0.3, .inner = 0.2, .softness = 0.02};
  base.intensity = 0.8;
  base.intensity2 = 0.1;
  std::vector<Layer> layers;
  for (int kind = 1; kind <= static_cast<int>(kLastKind); ++kind) {
    Layer layer = base;
    layer.kind = static_cast<LayerKind>(kind);
    if (layer.kind == LayerKind::kFade) continue;
    if (layer.kind == LayerKind::kGrid) layer.pixels = image;
    if (layer.kind == LayerKind::kNoise) layer.seed = 5;
    if (layer.kind == LayerKind::kWave || layer.kind == LayerKind::kNoise) layer.phase = 1.3;
    if (layer.kind == LayerKind::kImage) {
      layer.image = image->sha256;
      layer.pixels = image;
    }
    layers.push_back(layer);
  }
  return layers;
}

}  // namespace lab::light
