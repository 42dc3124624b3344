#include "tracker_svc/circle_fit_model.hpp"

#include "tracker_svc/circle_fit_lanes.hpp"

namespace lab::tracker::fit {

namespace {

LAB_INLINE Lanes whiteAt(const Disc& disc, const Lanes& x, const Lanes& y) {
  return disc.white + disc.slope_x * x + disc.slope_y * y;
}

/// What the model needs at every pixel of a pass, in registers or at hand.
struct Pass {
  Disc disc;
  Constants constants;
  float over_sigma;
  float over_cutoff;
  float contrast;
  float outline;
};

/// Eight pixels: slopes and certainty to window.slopes, residual to window.residual, its weight to
/// window.light.
/// @tparam kAll every lane is a pixel, and none is full: nothing is to be counted
template <bool kAll>
LAB_INLINE void lookAtEight(Window& window, int at, const Pass& pass, LaneCounts& counts,
                            Lanes& squares) {
  const Disc& disc = pass.disc;
  const Lanes x = loadLanes(window.x + at);
  const Lanes y = loadLanes(window.y + at);
  const Lanes value = loadLanes(window.value + at);
  Paint paint;
  paintAt(x, y, disc, pass.constants.rm, pass.outline, pass.over_sigma, paint);
  const Lanes white = whiteAt(disc, x, y);
  const Lanes lightness = disc.ratio + pass.contrast * paint.share;
  const Lanes signal = white * lightness;
  const Lanes residual = value - pass.constants.black - signal;
  const Lanes certain = kAll ? 1.0F / varianceOf(signal, pass.constants)
                             : certaintyOf(value, signal, pass.constants, counts);
  const Lanes square = residual * residual * certain;
  const Lanes belief = beliefOf(square, pass.over_cutoff);
  counts.weight += kAll ? belief : (certain > 0.0F ? belief : Lanes{});
  squares += square * belief;

  const Lanes rise = white * paint.slope * (pass.contrast * pass.over_sigma);
  const Lanes outward = rise * paint.over_distance;
  Slopes& kept = window.slopes[at / kLanes];
  storeLanes(kept.by[kX], -paint.out_x * outward);
  storeLanes(kept.by[kY], -paint.out_y * outward);
  storeLanes(kept.by[kSlopeX], lightness * x);
  storeLanes(kept.by[kSlopeY], lightness * y);
  storeLanes(kept.by[kWhite], lightness);
  storeLanes(kept.by[kScale], rise * (-pass.constants.radius));
  storeLanes(kept.by[kRatio], white * (1.0F - paint.share));
  storeLanes(kept.by[kSigma], rise * (disc.sigma * paint.over_distance - paint.z));
  storeLanes(kept.weight, certain);
  storeLanes(window.residual + at, residual);
  storeLanes(window.light + at, certain * belief);
}

/// The sums of one block, of the slopes from `first` on: fourteen, which leaves two registers.
LAB_INLINE void sumBlock(const Window& window, std::size_t first, double* normal, double* right) {
  Lanes normals[10] = {};
  Lanes rights[kBlock] = {};
  for (int at = 0; at < window.count; at += kLanes) {
    const Slopes& kept = window.slopes[at / kLanes];
    std::size_t pair = 0;
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kBlock; ++i) {
      const Lanes weighted = loadLanes(kept.by[first + i]) * loadLanes(window.light + at);
      rights[i] += weighted * loadLanes(window.residual + at);
#pragma GCC unroll 4
      for (std::size_t j = 0; j <= i; ++j) {
        normals[pair++] += weighted * loadLanes(kept.by[first + j]);
      }
    }
  }
  totalEach(normals, normal);
  totalEach(rights, right);
}

}  // namespace

__attribute__((target_clones("avx2", "default"))) void sumBlocks(Window& window,
                                                                 const Constants& constants,
                                                                 const Disc& disc, float cutoff,
                                                                 Blocks& blocks) {
  const Pass pass{disc,
                  constants,
                  1.0F / disc.sigma,
                  1.0F / (cutoff * cutoff),
                  1.0F - disc.ratio,
                  constants.radius * disc.scale};
  LaneCounts counts;
  Lanes squares = {};
  int at = 0;
  if (window.plain) {
    for (; at + kLanes < window.count; at += kLanes) {
      lookAtEight<true>(window, at, pass, counts, squares);
    }
    counts.pixels += static_cast<float>(at / kLanes);
  }
  for (; at < window.count; at += kLanes) {
    lookAtEight<false>(window, at, pass, counts, squares);
  }
  sumBlock(window, 0, blocks.odd.data(), blocks.right.data());
  sumBlock(window, kBlock, blocks.even.data(), blocks.right.data() + kBlock);
  blocks.squares = total(squares);
  counts.writeTo(blocks.counts);
}

__attribute__((target_clones("avx2", "default"))) void sumLast(Window& window, const Disc& disc,
                                                               const Row& by, float cutoff,
                                                               const BlockRow& row_x,
                                                               const BlockRow& row_y,
                                                               LastStep& last) {
  const float over_cutoff = 1.0F / (cutoff * cutoff);
  float moved[kUnknowns];
  float to_x[kBlock];
  float to_y[kBlock];
  for (std::size_t i = 0; i < kUnknowns; ++i) moved[i] = static_cast<float>(by[i]);
  for (std::size_t i = 0; i < kBlock; ++i) {
    to_x[i] = static_cast<float>(row_x[i]);
    to_y[i] = static_cast<float>(row_y[i]);
  }
  LaneCounts counts;
  Lanes sum_x = {};
  Lanes sum_y = {};
  Lanes xx = {};
  Lanes xy = {};
  Lanes yy = {};
  Lanes squares = {};
  for (int at = 0; at < window.count; at += kLanes) {
    const Slopes& kept = window.slopes[at / kLanes];
    const Lanes certain = loadLanes(kept.weight);
    Lanes residual = loadLanes(window.residual + at);
#pragma GCC unroll 16
    for (std::size_t i = 0; i < kUnknowns; ++i) residual -= moved[i] * loadLanes(kept.by[i]);
    const Lanes square = residual * residual * certain;
    const Lanes belief = beliefOf(square, over_cutoff);
    const Lanes weighted = residual * certain * belief;
    Lanes pull_x = to_x[0] * loadLanes(kept.by[0]);
    Lanes pull_y = to_y[0] * loadLanes(kept.by[0]);
#pragma GCC unroll 16
    for (std::size_t i = 1; i < kBlock; ++i) {
      pull_x += to_x[i] * loadLanes(kept.by[i]);
      pull_y += to_y[i] * loadLanes(kept.by[i]);
    }
    pull_x *= weighted;
    pull_y *= weighted;
    sum_x += pull_x;
    sum_y += pull_y;
    xx += pull_x * pull_x;
    xy += pull_x * pull_y;
    yy += pull_y * pull_y;
    squares += weighted * residual;
    counts.weight += certain > 0.0F ? belief : Lanes{};
    counts.pixels += certain > 0.0F ? Lanes{} + 1.0F : Lanes{};
    counts.cost += limitedCost(square);
    storeLanes(window.residual + at, weighted);
    const Lanes x = loadLanes(window.x + at);
    const Lanes y = loadLanes(window.y + at);
    storeLanes(window.light + at, whiteAt(disc, x, y));
  }
  last.x = total(sum_x);
  last.y = total(sum_y);
  last.variance = {total(xx), total(xy), total(yy)};
  last.squares = total(squares);
  counts.writeTo(last.counts);
  last.counts.cost = total(counts.cost);
}

__attribute__((target_clones("avx2", "default"))) double correlation(const Window& window) {
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

}  // namespace lab::tracker::fit
