#include "tracker_svc/circle_fit/circle_fit_model.hpp"

#include <algorithm>

#include "tracker_svc/circle_fit/circle_fit_lanes.hpp"

namespace lab::detector::fit {

namespace {

LAB_INLINE Lanes whiteAt(const Disc& disc, const Lanes& x, const Lanes& y) {
  return disc.white + disc.slope_x * x + disc.slope_y * y;
}

std::size_t eightsOf(const Window& window) {
  return static_cast<std::size_t>(window.count / kLanes);
}

/// Constants of a pass.
struct Pass {
  Disc disc;
  Constants constants;
  float over_sigma;
  float over_cutoff;
  float contrast;
};

// A pass loops over the pixels several times. In a single loop each step would wait for the
// previous one; out-of-order execution overlaps iterations only if they are short.

/// First loop: positions of eight pixels in the disc, stored where the derivatives go later.
LAB_INLINE void placeEight(Window& window, std::size_t eight, const Pass& pass) {
  const std::size_t at = eight * kLanes;
  Offset offset;
  wayAt(loadLanes(window.x + at), loadLanes(window.y + at), pass.disc, pass.constants,
        pass.over_sigma, offset);
  Slopes& kept = window.slopes[eight];
  storeLanes(kept.by[kX], offset.out_x);
  storeLanes(kept.by[kY], offset.out_y);
  storeLanes(kept.by[kScale], offset.z);
  storeLanes(kept.by[kSigma], offset.over_distance);
}

/// Second loop: the paint there, and its derivatives.
LAB_INLINE void paintEight(Window& window, std::size_t eight, const Pass& pass) {
  Slopes& kept = window.slopes[eight];
  const Lanes z = loadLanes(kept.by[kScale]);
  const Lanes over_distance = loadLanes(kept.by[kSigma]);
  Lanes share;
  Lanes slope;
  edgeProfile(z, share, slope);
  const Lanes rise = slope * (pass.contrast * pass.over_sigma);
  const Lanes inward = -rise * over_distance;
  storeLanes(kept.by[kX], loadLanes(kept.by[kX]) * inward);
  storeLanes(kept.by[kY], loadLanes(kept.by[kY]) * inward);
  storeLanes(kept.by[kScale], rise * (-pass.constants.radius));
  storeLanes(kept.by[kSigma], rise * (pass.disc.sigma * over_distance - z));
  storeLanes(kept.by[kWhite], pass.disc.ratio + pass.contrast * share);
  storeLanes(kept.by[kRatio], 1.0F - share);
}

/// Third loop: the light on it. Derivatives and inverse variances to window.slopes, residual to
/// window.residual.
/// @tparam kAll every lane is a usable pixel: no counting needed
template <bool kAll>
LAB_INLINE void lightEight(Window& window, std::size_t eight, const Pass& pass,
                           LaneCounts& counts) {
  const std::size_t at = eight * kLanes;
  Slopes& kept = window.slopes[eight];
  const Lanes x = loadLanes(window.x + at);
  const Lanes y = loadLanes(window.y + at);
  const Lanes value = loadLanes(window.value + at);
  const Lanes white = whiteAt(pass.disc, x, y);
  const Lanes lightness = loadLanes(kept.by[kWhite]);
  const Lanes signal = white * lightness;
  storeLanes(window.residual + at, value - pass.constants.black - signal);
  storeLanes(kept.weight, kAll ? 1.0F / varianceOf(signal, pass.constants)
                               : inverseVarianceOf(value, signal, pass.constants, counts));
  for (const Unknown lit : {kX, kY, kScale, kRatio, kSigma}) {
    storeLanes(kept.by[lit], white * loadLanes(kept.by[lit]));
  }
  storeLanes(kept.by[kSlopeX], lightness * x);
  storeLanes(kept.by[kSlopeY], lightness * y);
}

/// Last loop: weights of the residuals to window.light, and the right sides.
template <bool kAll>
LAB_INLINE void believeEight(Window& window, std::size_t eight, const Pass& pass,
                             LaneCounts& counts, Lanes& squares, Lanes* rights) {
  const std::size_t at = eight * kLanes;
  const Slopes& kept = window.slopes[eight];
  const Lanes residual = loadLanes(window.residual + at);
  const Lanes certain = loadLanes(kept.weight);
  const Lanes square = residual * residual * certain;
  const Lanes pixel_weight = tukeyWeight(square, pass.over_cutoff);
  counts.weight += kAll ? pixel_weight : (certain > 0.0F ? pixel_weight : Lanes{});
  squares += square * pixel_weight;
  const Lanes weight = certain * pixel_weight;
  const Lanes weighted = weight * residual;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < kUnknowns; ++i) rights[i] += weighted * loadLanes(kept.by[i]);
  storeLanes(window.light + at, weight);
}

/// The normal matrix of one block, from derivative `first` on: ten sums, which stay in registers.
LAB_INLINE void sumBlock(const Window& window, std::size_t first, double* normal) {
  Lanes normals[10];
#pragma GCC unroll 10
  for (Lanes& sum : normals) sum = Lanes{};
  const std::size_t eights = eightsOf(window);
  for (std::size_t eight = 0; eight < eights; ++eight) {
    const Slopes& kept = window.slopes[eight];
    const Lanes weight = loadLanes(window.light + eight * kLanes);
    std::size_t pair = 0;
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kBlock; ++i) {
      const Lanes weighted = loadLanes(kept.by[first + i]) * weight;
#pragma GCC unroll 4
      for (std::size_t j = 0; j <= i; ++j) {
        normals[pair++] += weighted * loadLanes(kept.by[first + j]);
      }
    }
  }
  totalEach(normals, normal);
}

}  // namespace

LAB_FIT_CLONES
void sumBlocks(Window& window, const Constants& constants, const Disc& disc, float cutoff,
               Blocks& blocks) {
  const Pass pass{disc, constants, 1.0F / disc.sigma, 1.0F / (cutoff * cutoff), 1.0F - disc.ratio};
  LaneCounts counts;
  Lanes squares = {};
  Lanes rights[kUnknowns];
#pragma GCC unroll 8
  for (Lanes& sum : rights) sum = Lanes{};
  const std::size_t eights = eightsOf(window);
  const std::size_t plain = window.plain && eights > 0 ? eights - 1 : 0;
  for (std::size_t i = 0; i < eights; ++i) placeEight(window, i, pass);
  for (std::size_t i = 0; i < eights; ++i) paintEight(window, i, pass);
  for (std::size_t i = 0; i < plain; ++i) lightEight<true>(window, i, pass, counts);
  for (std::size_t i = plain; i < eights; ++i) lightEight<false>(window, i, pass, counts);
  for (std::size_t i = 0; i < plain; ++i) {
    believeEight<true>(window, i, pass, counts, squares, rights);
  }
  for (std::size_t i = plain; i < eights; ++i) {
    believeEight<false>(window, i, pass, counts, squares, rights);
  }
  counts.pixels += static_cast<float>(plain);
  sumBlock(window, 0, blocks.odd.data());
  sumBlock(window, kBlock, blocks.even.data());
  totalEach(rights, blocks.right.data());
  blocks.squares = total(squares);
  counts.writeTo(blocks.counts);
}

LAB_FIT_CLONES
void sumLast(Window& window, const Row& by, float cutoff, const BlockRow& row_x,
             const BlockRow& row_y, LastStep& last) {
  const float over_cutoff = 1.0F / (cutoff * cutoff);
  float moved[kUnknowns];
  float to_x[kBlock];
  float to_y[kBlock];
  for (std::size_t i = 0; i < kUnknowns; ++i) moved[i] = static_cast<float>(by[i]);
  for (std::size_t i = 0; i < kBlock; ++i) {
    to_x[i] = static_cast<float>(row_x[i]);
    to_y[i] = static_cast<float>(row_y[i]);
  }
  Lanes weight = {};
  Lanes cost = {};
  Lanes sum_x = {};
  Lanes sum_y = {};
  Lanes xx = {};
  Lanes xy = {};
  Lanes yy = {};
  Lanes squares = {};
  // Two loops, as in a pass.
  const std::size_t eights = eightsOf(window);
  for (std::size_t eight = 0; eight < eights; ++eight) {
    const std::size_t at = eight * kLanes;
    const Slopes& kept = window.slopes[eight];
    Lanes by_odd = moved[0] * loadLanes(kept.by[0]);
    Lanes by_even = moved[kBlock] * loadLanes(kept.by[kBlock]);
#pragma GCC unroll 4
    for (std::size_t i = 1; i < kBlock; ++i) {
      by_odd += moved[i] * loadLanes(kept.by[i]);
      by_even += moved[kBlock + i] * loadLanes(kept.by[kBlock + i]);
    }
    storeLanes(window.residual + at, loadLanes(window.residual + at) - (by_odd + by_even));
  }
  for (std::size_t eight = 0; eight < eights; ++eight) {
    const std::size_t at = eight * kLanes;
    const Slopes& kept = window.slopes[eight];
    const Lanes certain = loadLanes(kept.weight);
    const Lanes residual = loadLanes(window.residual + at);
    Lanes pull_x = to_x[0] * loadLanes(kept.by[0]);
    Lanes pull_y = to_y[0] * loadLanes(kept.by[0]);
#pragma GCC unroll 4
    for (std::size_t i = 1; i < kBlock; ++i) {
      pull_x += to_x[i] * loadLanes(kept.by[i]);
      pull_y += to_y[i] * loadLanes(kept.by[i]);
    }
    const Lanes square = residual * residual * certain;
    const Lanes pixel_weight = tukeyWeight(square, over_cutoff);
    const Lanes weighted = residual * certain * pixel_weight;
    pull_x *= weighted;
    pull_y *= weighted;
    sum_x += pull_x;
    sum_y += pull_y;
    xx += pull_x * pull_x;
    xy += pull_x * pull_y;
    yy += pull_y * pull_y;
    squares += weighted * residual;
    weight += pixel_weight;
    cost += tukeyCost(square);
    storeLanes(window.residual + at, weighted);
  }
  last.x = total(sum_x);
  last.y = total(sum_y);
  last.variance = {total(xx), total(xy), total(yy)};
  last.squares = total(squares);
  last.weight = total(weight);
  last.cost = total(cost);
}

LAB_FIT_CLONES
void layLight(Window& window, const Disc& disc) {
  for (int at = 0; at < window.count; at += kLanes) {
    storeLanes(window.light + at,
               whiteAt(disc, loadLanes(window.x + at), loadLanes(window.y + at)));
  }
}

LAB_FIT_CLONES
double correlation(const Window& window) {
  Lanes together = {};
  Lanes squares = {};
  for (int at = 0; at + kLanes < window.count; at += kLanes) {
    const Lanes here = loadLanes(window.residual + at);
    const Lanes next = loadLanes(window.residual + at + 1);
    together += here * next;
    squares += here * here;
  }
  const double all = total(squares);
  return all > 0 ? total(together) / all : 0;
}

}  // namespace lab::detector::fit
