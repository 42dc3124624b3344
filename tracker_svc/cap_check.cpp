#include "tracker_svc/cap_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// How bright it is just inside of the rim, and at it, by direction.
struct Rim {
  std::array<float, kDirections> inside{};
  std::array<float, kDirections> at{};
};

/// All of it in the picture.
__attribute__((target_clones("avx2", "default"))) void readRim(const optics::GreyView& picture,
                                                               float x, float y, float radius,
                                                               const LocalScale& scale,
                                                               const Circle& circle, Rim& rim) {
  constexpr std::array<float, 4> kFrom = {kInside[0], kInside[1], kAtRim[0], kAtRim[1]};
  std::array<std::int32_t, kFrom.size() * kDirections> places;
  const auto stride = static_cast<std::int32_t>(picture.stride);
  for (std::size_t k = 0; k < kFrom.size(); ++k) {
    const float far = radius + kFrom[k];
    for (std::size_t i = 0; i < kDirections; ++i) {
      const float du = scale.forward[0] * circle.cos[i] + scale.forward[1] * circle.sin[i];
      const float dv = scale.forward[2] * circle.cos[i] + scale.forward[3] * circle.sin[i];
      places[k * kDirections + i] = static_cast<std::int32_t>(y + far * dv) * stride +
                                    static_cast<std::int32_t>(x + far * du);
    }
  }
  const auto read = [&](std::size_t k, std::size_t i) {
    return static_cast<int>(picture.data[places[k * kDirections + i]]);
  };
  for (std::size_t i = 0; i < kDirections; ++i) {
    rim.inside[i] = static_cast<float>(read(0, i) + read(1, i));
    rim.at[i] = static_cast<float>(read(2, i) + read(3, i));
  }
}

/// Directions that lead out of the picture are left out.
std::size_t readRimInPart(const optics::GreyView& picture, float x, float y, float radius,
                          const LocalScale& scale, const Circle& circle, Rim& rim) {
  const auto sample = [&](float u, float v) -> float {
    return picture.row(static_cast<int>(v))[static_cast<int>(u)];
  };
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
    for (const float r : kInside) {
      rim.inside[count] += sample(x + (radius + r) * du, y + (radius + r) * dv);
    }
    for (const float r : kAtRim) {
      rim.at[count] += sample(x + (radius + r) * du, y + (radius + r) * dv);
    }
    ++count;
  }
  return count;
}

}  // namespace

float rimContrast(const optics::GreyView& picture, optics::Pixel middle, const LocalScale& scale,
                  const optics::CapGeometry& cap, const optics::Imaging& imaging) {
  const Circle& circle = directions();
  const auto radius = static_cast<float>(cap.cap_radius);
  const auto x = static_cast<float>(middle.x) + 0.5F;
  const auto y = static_cast<float>(middle.y) + 0.5F;
  const double last = cap.cap_radius + static_cast<double>(kAtRim[1]);
  const double across = std::abs(static_cast<double>(scale.forward[0])) +
                        std::abs(static_cast<double>(scale.forward[1]));
  const double along = std::abs(static_cast<double>(scale.forward[2])) +
                       std::abs(static_cast<double>(scale.forward[3]));
  Rim rim;
  std::size_t count = kDirections;
  if (picture.contains(middle.x, middle.y, last * std::max(across, along) + 1)) {
    readRim(picture, x, y, radius, scale, circle, rim);
  } else {
    count = readRimInPart(picture, x, y, radius, scale, circle, rim);
  }
  if (count < kDirections / 2) return 0;
  const float softer = 2 * static_cast<float>(imaging.read_noise - 2 * imaging.black);
  std::array<float, kDirections> contrast{};
  for (std::size_t i = 0; i < kDirections; ++i) {
    contrast[i] = (rim.inside[i] - rim.at[i]) / std::max(rim.inside[i] + rim.at[i] + softer, 1.0F);
  }
  const auto half = contrast.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(contrast.begin(), half, contrast.begin() + static_cast<std::ptrdiff_t>(count));
  return *half;
}

}  // namespace lab::tracker
