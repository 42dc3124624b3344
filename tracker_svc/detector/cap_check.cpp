#include "tracker_svc/detector/cap_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>

#include "light/field/target_clones.hpp"
#include "light/median.hpp"
#include "tracker_svc/detector/saturation.hpp"

namespace lab::detector {
namespace {

constexpr std::size_t kDirections = 24;
constexpr std::size_t kRoughDirections = 8;
constexpr std::array<float, 2> kInside = {-0.0045F, -0.0025F};  // [m] from the rim
constexpr std::array<float, 2> kAtRim = {0.0005F, 0.0014F};     // [m]

constexpr std::size_t kLeastKnown = 3;  // at least one in this many directions must be unsaturated

// [read noise] brightness of a cap below which single pixels are unreliable
constexpr float kFaintLight = 8;

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

using Contrasts = float __attribute__((vector_size(32)));

/// The value with `rank` smaller ones (ties broken by index). Compares all with all, which is
/// branchless.
LAB_TARGET_CLONES float valueOfRank(const std::array<float, kDirections>& values, std::size_t count,
                                    std::size_t rank) {
  constexpr std::size_t kLanes = 8;
  static_assert(kDirections % kLanes == 0);
  using Numbers = std::int32_t __attribute__((vector_size(32)));
  Contrasts largest = Contrasts{} + std::numeric_limits<float>::lowest();
  for (std::size_t first = 0; first < kDirections; first += kLanes) {
    Contrasts here;
    std::memcpy(&here, values.data() + first, sizeof here);
    Numbers smaller{};  // counts downwards: true is -1
    for (std::size_t i = 0; i < count; ++i) smaller += values[i] < here;
    const Numbers number = Numbers{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int32_t>(first);
    const Numbers may =
        (-smaller <= static_cast<std::int32_t>(rank)) & (number < static_cast<std::int32_t>(count));
    const Contrasts candidate = may ? here : largest;
    largest = candidate > largest ? candidate : largest;
  }
  float found = largest[0];
  for (std::size_t lane = 1; lane < kLanes; ++lane) found = std::max(found, largest[lane]);
  return found;
}

/// Brightness just inside the rim and at it, by direction.
struct Rim {
  std::array<float, kDirections> inside{};
  std::array<float, kDirections> at{};
};

/// Reads a rim that lies completely in the picture.
/// @tparam kCount number of directions, equally spaced
template <std::size_t kCount>
[[gnu::always_inline]] inline void readRimOf(const optics::GreyView& picture, float x, float y,
                                             float radius, const LocalScale& scale,
                                             const Circle& circle, Rim& rim) {
  constexpr std::size_t kEach = kDirections / kCount;
  constexpr std::array<float, 4> kFrom = {kInside[0], kInside[1], kAtRim[0], kAtRim[1]};
  std::array<std::int32_t, kFrom.size() * kCount> places;
  const auto stride = static_cast<std::int32_t>(picture.stride);
  for (std::size_t k = 0; k < kFrom.size(); ++k) {
    const float far = radius + kFrom[k];
    for (std::size_t i = 0; i < kCount; ++i) {
      const float cosine = circle.cos[i * kEach];
      const float sine = circle.sin[i * kEach];
      const float du = scale.forward[0] * cosine + scale.forward[1] * sine;
      const float dv = scale.forward[2] * cosine + scale.forward[3] * sine;
      places[k * kCount + i] = static_cast<std::int32_t>(y + far * dv) * stride +
                               static_cast<std::int32_t>(x + far * du);
    }
  }
  const auto read = [&](std::size_t k, std::size_t i) {
    return static_cast<int>(picture.data[places[k * kCount + i]]);
  };
  for (std::size_t i = 0; i < kCount; ++i) {
    rim.inside[i] = static_cast<float>(read(0, i) + read(1, i));
    rim.at[i] = static_cast<float>(read(2, i) + read(3, i));
  }
}

LAB_TARGET_CLONES void readRim(const optics::GreyView& picture, float x, float y, float radius,
                               const LocalScale& scale, const Circle& circle, Rim& rim) {
  readRimOf<kDirections>(picture, x, y, radius, scale, circle, rim);
}

LAB_TARGET_CLONES void readRimRoughly(const optics::GreyView& picture, float x, float y,
                                      float radius, const LocalScale& scale, const Circle& circle,
                                      Rim& rim) {
  readRimOf<kRoughDirections>(picture, x, y, radius, scale, circle, rim);
}

/// Reads the directions that lie in the picture.
/// @param full [DN] minimum value assumed for pixels that are saturated, or may be within noise
std::size_t readRimInPart(const optics::GreyView& picture, float x, float y, float radius,
                          const LocalScale& scale, const Circle& circle, float full, Rim& rim) {
  const auto sample = [&](float u, float v) -> float {
    const float value = picture.row(static_cast<int>(v))[static_cast<int>(u)];
    return value < kNearlySaturated ? value : std::max(value, full);
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

bool anyFull(const Rim& rim) {
  Contrasts most{};
  for (std::size_t first = 0; first < kDirections; first += 8) {
    Contrasts here;
    std::memcpy(&here, rim.inside.data() + first, sizeof here);
    most = here > most ? here : most;
  }
  float brightest = 0;
  for (int lane = 0; lane < 8; ++lane) brightest = std::max(brightest, most[lane]);
  return brightest >= 2 * kSaturated;
}

/// Directions that are saturated inside the rim and at it have unknown contrast. Moves the others
/// to the front. @return their number
std::size_t keepKnown(float full, std::size_t count, Rim& rim) {
  std::size_t known = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (rim.inside[i] >= 2 * full && rim.at[i] >= 2 * full) continue;
    rim.inside[known] = rim.inside[i];
    rim.at[known++] = rim.at[i];
  }
  return known;
}

/// Mean brightness inside the rim [DN] over the directions that were read.
float lightOf(const Rim& rim, std::size_t count, const optics::Imaging& imaging) {
  const float sum = std::accumulate(rim.inside.begin(), rim.inside.end(), 0.0F);
  return sum / static_cast<float>(kInside.size() * count) - static_cast<float>(imaging.black);
}

/// For light so dim that single pixels are unreliable: averages over sectors of several directions,
/// with more pixels along each. The rim must lie completely in the picture.
float rimInTheDark(const optics::GreyView& picture, float x, float y, float radius,
                   const LocalScale& scale, const optics::Imaging& imaging) {
  constexpr std::size_t kSectors = 12;
  constexpr std::size_t kOfSector = 5;
  constexpr std::array<float, 3> kDarkInside = {-0.0045F, -0.0035F, -0.0025F};  // [m] from the rim
  constexpr std::array<float, 3> kDarkAtRim = {0.0003F, 0.0009F, 0.0015F};      // [m]
  const float softer = 2 * static_cast<float>(imaging.read_noise / 2 - imaging.black) *
                       kDarkInside.size() * kOfSector;
  std::array<float, kSectors> contrast{};
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    float inside = 0;
    float at_rim = 0;
    for (std::size_t i = 0; i < kOfSector; ++i) {
      const float angle = 2 * std::numbers::pi_v<float> *
                          static_cast<float>(sector * kOfSector + i) / (kSectors * kOfSector);
      const float cosine = std::cos(angle);
      const float sine = std::sin(angle);
      const float du = scale.forward[0] * cosine + scale.forward[1] * sine;
      const float dv = scale.forward[2] * cosine + scale.forward[3] * sine;
      const auto read = [&](float r) {
        const int column = static_cast<int>(x + (radius + r) * du);
        return static_cast<float>(picture.row(static_cast<int>(y + (radius + r) * dv))[column]);
      };
      for (const float r : kDarkInside) inside += read(r);
      for (const float r : kDarkAtRim) at_rim += read(r);
    }
    contrast[sector] = (inside - at_rim) / std::max(inside + at_rim + softer, 1.0F);
  }
  return medianOf(contrast);
}

}  // namespace

float rimContrast(const optics::GreyView& picture, optics::Pixel middle, const LocalScale& scale,
                  const optics::CapGeometry& cap, const optics::Imaging& imaging, RimSampling look,
                  float white) {
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
    if (look == RimSampling::kRough) {
      count = kRoughDirections;
      readRimRoughly(picture, x, y, radius, scale, circle, rim);
    } else {
      readRim(picture, x, y, radius, scale, circle, rim);
    }
    if (lightOf(rim, count, imaging) < kFaintLight * static_cast<float>(imaging.read_noise)) {
      return rimInTheDark(picture, x, y, radius, scale, imaging);
    }
  } else {
    count = readRimInPart(picture, x, y, radius, scale, circle, 0, rim);
    if (count < kDirections / 2) return 0;
  }
  if (anyFull(rim)) {
    const float full = std::max(kNearlySaturated, white + static_cast<float>(imaging.black));
    rim = {};
    count = readRimInPart(picture, x, y, radius, scale, circle, full, rim);
    const std::size_t known = keepKnown(full, count, rim);
    if (known * kLeastKnown < count) return 0;
    count = known;
  }
  const float softer = 2 * static_cast<float>(imaging.read_noise - 2 * imaging.black);
  std::array<float, kDirections> contrast{};
  for (std::size_t i = 0; i < count; ++i) {
    contrast[i] = (rim.inside[i] - rim.at[i]) / std::max(rim.inside[i] + rim.at[i] + softer, 1.0F);
  }
  return valueOfRank(contrast, count, count / 2);
}

}  // namespace lab::detector
