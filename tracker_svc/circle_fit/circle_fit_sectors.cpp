#include "tracker_svc/circle_fit/circle_fit_sectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracker_svc/detector/saturation.hpp"

namespace lab::detector::fit {
namespace {

constexpr float kClear = 1.2F;  // [sigma] from the outline: paint and white are not mixed there
constexpr float kBand = 1.5F;   // [px] wide
constexpr float kMostRatio = 0.6F;
constexpr float kSure = 2.5F;   // [standard errors]
constexpr int kLeastWhite = 5;  // at most one of this many pixels outside is dark: holes and rims
// number of sectors: glare, debris and light across an edge may affect some
constexpr int kMostBad = 3;

// Share of the light that pixels return: least squares of value = share * light.
struct Share {
  float value_light = 0;
  float light_light = 0;
  float variance = 0;  // of value_light
  void add(float value, float light, float noise) {
    value_light += value * light;
    light_light += light * light;
    variance += light * light * noise;
  }
  [[nodiscard]] bool any() const { return light_light > 0; }
  [[nodiscard]] float value() const { return value_light / light_light; }
  [[nodiscard]] float error2() const { return variance / (light_light * light_light); }
};

int sectorOf(float dx, float dy) {
  return (dx > 0 ? 1 : 0) + (dy > 0 ? 2 : 0) + (std::abs(dx) > std::abs(dy) ? 4 : 0);
}

}  // namespace

bool darkAllAround(const Window& window, const Constants& constants, const Disc& disc,
                   float noise) {
  std::array<Share, 8> inside{};
  std::array<Share, 8> outside{};
  Share core;
  int all_outside = 0;
  int dark_outside = 0;
  const float outline = constants.radius * disc.scale;
  const float clear = kClear * disc.sigma;
  for (int i = 0; i < window.count; ++i) {
    if (window.value[i] < 0) continue;
    const float dx = window.x[i] - disc.x;
    const float dy = window.y[i] - disc.y;
    const float distance = std::sqrt(constants.outline.squareAt(dx, dy)) - outline;
    const float value = window.value[i] - constants.black;
    // No pixel value exceeds saturation.
    const float light = std::clamp(window.light[i], 0.0F, kMaxDn - constants.black);
    const float variance = constants.noiseAt(std::max(0.0F, value));
    const auto sector = static_cast<std::size_t>(sectorOf(dx, dy));
    if (distance > clear) {
      all_outside += 1;
      const bool dark = value < kMostRatio * light - 2 * noise * std::sqrt(variance);
      dark_outside += dark ? 1 : 0;
    }
    if (distance > clear && distance < clear + kBand) {
      outside[sector].add(value, light, variance);
    } else if (distance < -clear && distance > -clear - kBand) {
      inside[sector].add(value, light, variance);
    } else if (distance < -clear - kBand) {
      core.add(value, light, variance);
    }
  }
  int bad = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const Share& in = inside[i];
    const Share& out = outside[i];
    if (!in.any() || !out.any()) continue;  // outside the picture, or a tiny circle
    const float error = noise * std::sqrt(in.error2() + out.error2());
    const bool darker =
        out.value() - in.value() > kSure * error && in.value() < kMostRatio * out.value() + error;
    bad += darker ? 0 : 1;
  }
  return bad <= kMostBad && dark_outside * kLeastWhite < all_outside &&
         (!core.any() || core.value() < kMostRatio + noise * std::sqrt(core.error2()));
}

bool darkInside(const Window& window, const Constants& constants, float sigma) {
  constexpr float kMiddle = 0.4F;  // [radius]
  // limit for the middle: a bright middle has bright pixels around it
  constexpr float kShare = 0.6F;
  float inside = 0;
  float outside = 0;
  float inside_count = 0;
  float outside_count = 0;
  const float middle = kMiddle * constants.radius;
  const float clear = constants.radius + kClear * sigma;
  for (int i = 0; i < window.count; ++i) {
    if (window.value[i] < 0) continue;
    const float square = constants.outline.squareAt(window.x[i], window.y[i]);
    const float value = window.value[i] - constants.black;
    if (square < middle * middle) {
      inside += value;
      inside_count += 1;
    } else if (square > clear * clear) {
      outside += value;
      outside_count += 1;
    }
  }
  if (inside_count < 1 || outside_count < 1) return false;
  const float error = std::sqrt(constants.floor_variance / inside_count);
  return inside / inside_count < kShare * outside / outside_count + 2 * error;
}

}  // namespace lab::detector::fit
