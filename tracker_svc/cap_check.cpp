#include "tracker_svc/cap_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lab::tracker {
namespace {

constexpr std::size_t kDirections = 24;
constexpr std::array<float, 2> kInside = {-0.0045F, -0.0025F};  // [m] from the rim
constexpr std::array<float, 2> kAtRim = {0.0005F, 0.0014F};     // [m]

struct Circle {
  std::array<float, kDirections> cos{};
  std::array<float, kDirections> sin{};
};

const Circle& directions() {
  static const Circle kCircle = [] {
    Circle circle;
    for (std::size_t i = 0; i < kDirections; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kDirections;
      circle.cos[i] = static_cast<float>(std::cos(angle));
      circle.sin[i] = static_cast<float>(std::sin(angle));
    }
    return circle;
  }();
  return kCircle;
}

}  // namespace

float rimContrast(const optics::GreyView& picture, optics::Pixel middle, const LocalScale& scale,
                  const optics::CapGeometry& cap, const optics::Imaging& imaging) {
  const Circle& circle = directions();
  const auto radius = static_cast<float>(cap.cap_radius);
  const float softer = 2 * static_cast<float>(imaging.read_noise - 2 * imaging.black);
  const auto x = static_cast<float>(middle.x) + 0.5F;
  const auto y = static_cast<float>(middle.y) + 0.5F;
  const auto sample = [&](float u, float v) -> float {
    return picture.row(static_cast<int>(v))[static_cast<int>(u)];
  };
  std::array<float, kDirections> contrast{};
  std::size_t count = 0;
  const float last = radius + kAtRim[1];
  const auto width = static_cast<float>(picture.width);
  const auto height = static_cast<float>(picture.height);
  for (std::size_t i = 0; i < kDirections; ++i) {
    const float du = scale.forward[0] * circle.cos[i] + scale.forward[1] * circle.sin[i];
    const float dv = scale.forward[2] * circle.cos[i] + scale.forward[3] * circle.sin[i];
    const float far_u = x + last * du;
    const float far_v = y + last * dv;
    if (!(far_u >= 0 && far_v >= 0 && far_u < width && far_v < height)) continue;
    float inside = 0;
    float rim = 0;
    for (const float r : kInside) inside += sample(x + (radius + r) * du, y + (radius + r) * dv);
    for (const float r : kAtRim) rim += sample(x + (radius + r) * du, y + (radius + r) * dv);
    contrast[count++] = (inside - rim) / std::max(inside + rim + softer, 1.0F);
  }
  if (count < kDirections / 2) return 0;
  const auto half = contrast.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(contrast.begin(), half, contrast.begin() + static_cast<std::ptrdiff_t>(count));
  return *half;
}

}  // namespace lab::tracker
