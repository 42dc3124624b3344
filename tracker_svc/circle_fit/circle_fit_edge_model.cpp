#include "tracker_svc/circle_fit/circle_fit_edge_model.hpp"

#include <cmath>

#include "tracker_svc/circle_fit/circle_fit_lanes.hpp"

namespace lab::detector::fit {
namespace {

struct Side {
  Lanes share;  // 0 behind the line, 1 beyond
  Lanes rise;   // d share / d distance [1/px]
  Lanes along;  // [px] along the line
  Lanes z;
};

LAB_INLINE void sideOf(const Line& line, float bend, float edge_sigma, const Lanes& x,
                       const Lanes& y, Side& side) {
  const float nx = line.nx;
  const float ny = line.ny;
  side.along = nx * y - ny * x;
  const Lanes distance = nx * x + ny * y - line.offset + side.along * side.along * (0.5F * bend);
  side.z = distance / edge_sigma;
  Lanes slope;
  edgeProfile(side.z, side.share, slope);
  side.rise = slope / edge_sigma;
}

template <std::size_t kLines>
LAB_INLINE void sumAll(Window& window, const Constants& constants, const LitDisc& lit, float cutoff,
                       Sums<litUnknowns(kLines)>& sums) {
  constexpr std::size_t kCount = litUnknowns(kLines);
  constexpr std::size_t kLevels = levelsOf(kLines);
  const Disc& disc = lit.disc;
  const float over_sigma = 1.0F / disc.sigma;
  const float over_cutoff = 1.0F / (cutoff * cutoff);
  const float contrast = 1.0F - disc.ratio;
  LaneSums<kCount> lanes;
  LaneCounts counts;
  for (int at = 0; at < window.count; at += kLanes) {
    const Lanes x = loadLanes(window.x + at);
    const Lanes y = loadLanes(window.y + at);
    const Lanes value = loadLanes(window.value + at);
    Paint paint;
    paintAt(x, y, disc, constants, over_sigma, paint);

    Side side[kLines + 1];  // size kLines may be 0
    for (std::size_t i = 0; i < kLines; ++i) {
      sideOf(lit.line[i], kLines == 1 ? lit.bend : 0.0F, lit.edge_sigma, x, y, side[i]);
    }
    Lanes basis[kLevels];
    Lanes jump[kLines + 1];  // d W / d share of each line
    const float over_radius = 1.0F / constants.radius;
    const Lanes u = x * over_radius;
    const Lanes v = y * over_radius;
    if constexpr (kLines == 0) {
      basis[0] = Lanes{} + 1.0F;
      basis[1] = u * u;
      basis[2] = u * v;
      basis[3] = v * v;
      basis[4] = basis[1] * u;
      basis[5] = basis[1] * v;
      basis[6] = basis[3] * u;
      basis[7] = basis[3] * v;
    } else if constexpr (kLines == 1) {
      basis[0] = 1.0F - side[0].share;
      basis[1] = side[0].share;
      jump[0] = Lanes{} + (lit.level[1] - lit.level[0]);
    } else {
      const Lanes& a = side[0].share;
      const Lanes& b = side[1].share;
      basis[0] = (1.0F - a) * (1.0F - b);
      basis[1] = a * (1.0F - b);
      basis[2] = (1.0F - a) * b;
      basis[3] = a * b;
      jump[0] = (lit.level[1] - lit.level[0]) * (1.0F - b) + (lit.level[3] - lit.level[2]) * b;
      jump[1] = (lit.level[2] - lit.level[0]) * (1.0F - a) + (lit.level[3] - lit.level[1]) * a;
    }
    Lanes white = disc.slope_x * x + disc.slope_y * y;
    for (std::size_t i = 0; i < kLevels; ++i) white += lit.level[i] * basis[i];

    const Lanes lightness = disc.ratio + contrast * paint.share;
    const Lanes outward = paint.slope * over_sigma * paint.over_distance * contrast;
    const Lanes paint_x = outward * paint.out_x;
    const Lanes paint_y = outward * paint.out_y;
    Lanes crossing = {};
    if constexpr (kLines == 0) {
      const float* l = lit.level.data();
      const Lanes by_u = u * (2 * l[1] + 3 * l[4] * u) + v * (l[2] + 2 * l[5] * u + l[6] * v);
      const Lanes by_v = v * (2 * l[3] + 3 * l[7] * v) + u * (l[2] + 2 * l[6] * v + l[5] * u);
      crossing = (disc.slope_x + by_u * over_radius) * paint_x +
                 (disc.slope_y + by_v * over_radius) * paint_y;
      crossing *= disc.sigma * disc.sigma;
    }
    for (std::size_t i = 0; i < kLines; ++i) {
      const Line& line = lit.line[i];
      const Lanes rho = atMost(atLeast(paint.over_distance * (disc.sigma / lit.edge_sigma) *
                                           (line.nx * paint.out_x + line.ny * paint.out_y),
                                       -1.0F),
                               1.0F);
      const Lanes both = side[i].z * paint.z;
      const Lanes third = (side[i].z * side[i].z - 1.0F) * (paint.z * paint.z - 1.0F);
      crossing += jump[i] * side[i].rise * paint.slope * rho *
                  (1.0F + rho * (0.5F * both + rho * (1.0F / 6.0F) * third));
    }
    if constexpr (kLines > 0) crossing *= contrast * lit.edge_sigma;
    const Lanes signal = white * lightness + crossing;
    const Lanes residual = value - constants.black - signal;
    const Lanes certain = inverseVarianceOf(value, signal, constants, counts);
    const Lanes square = residual * residual * certain;
    const Lanes pixel_weight = tukeyWeight(square, over_cutoff);
    const Lanes weight = certain * pixel_weight;
    counts.weight += certain > 0.0F ? pixel_weight : Lanes{};
    counts.cost += tukeyCost(square);

    const Lanes rise = white * paint.slope * (contrast * over_sigma);
    Lanes slopes[kCount];
    slopes[kLitX] = -white * paint_x;
    slopes[kLitY] = -white * paint_y;
    slopes[kLitSlopeX] = lightness * x;
    slopes[kLitSlopeY] = lightness * y;
    slopes[kLitScale] = rise * (-constants.radius);
    slopes[kLitRatio] = white * (1.0F - paint.share);
    slopes[kLitSigma] = rise * (disc.sigma * paint.over_distance - paint.z);
    for (std::size_t i = 0; i < kLevels; ++i) slopes[kLitLevel + i] = lightness * basis[i];
    Lanes softness = {};
    for (std::size_t i = 0; i < kLines; ++i) {
      const Lanes moved = lightness * jump[i] * side[i].rise;
      slopes[kLitLevel + kLevels + 2 * i] = moved * side[i].along;
      slopes[kLitLevel + kLevels + 2 * i + 1] = -moved;
      softness -= moved * side[i].z;
    }
    if constexpr (kLines > 0) slopes[kLitLevel + kLevels + 2 * kLines] = softness;
    if constexpr (kLines == 1) {
      slopes[kCount - 1] =
          lightness * jump[0] * side[0].rise * side[0].along * side[0].along * 0.5F;
    }
    lanes.add(slopes, residual, weight);
    storeLanes(window.residual + at, residual * weight);
    storeLanes(window.light + at, white);
  }
  lanes.writeTo(sums);
  counts.writeTo(sums.counts);
  sums.counts.cost = total(counts.cost);
}

}  // namespace

template <>
LAB_FIT_CLONES void sumLitDisc<0>(Window& window, const Constants& constants, const LitDisc& disc,
                                  float cutoff, Sums<litUnknowns(0)>& sums) {
  sumAll<0>(window, constants, disc, cutoff, sums);
}

template <>
LAB_FIT_CLONES void sumLitDisc<1>(Window& window, const Constants& constants, const LitDisc& disc,
                                  float cutoff, Sums<litUnknowns(1)>& sums) {
  sumAll<1>(window, constants, disc, cutoff, sums);
}

template <>
LAB_FIT_CLONES void sumLitDisc<2>(Window& window, const Constants& constants, const LitDisc& disc,
                                  float cutoff, Sums<litUnknowns(2)>& sums) {
  sumAll<2>(window, constants, disc, cutoff, sums);
}

}  // namespace lab::detector::fit
