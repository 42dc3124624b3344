#include "tracker_svc/circle_fit_model.hpp"

#include "tracker_svc/circle_fit_lanes.hpp"

namespace lab::tracker::fit {
__attribute__((target_clones("avx2", "default")))
void sumLinear(const Window& window, const Constants& constants, float sigma, Sums<4>& sums) {
  const float* rm = constants.rm;
  const float over_sigma = 1.0F / sigma;
  LaneSums<4> lanes;
  for (int at = 0; at < window.count; at += kLanes) {
    const Lanes x = loadLanes(window.x + at);
    const Lanes y = loadLanes(window.y + at);
    const Lanes value = loadLanes(window.value + at);
    const Lanes qx = rm[0] * x + rm[1] * y;
    const Lanes qy = rm[2] * x + rm[3] * y;
    const Lanes distance = rootOf(qx * qx + qy * qy + sigma * sigma);
    Lanes share;
    Lanes slope;
    edgeProfile((distance - constants.radius) * over_sigma, share, slope);
    const Lanes outward = slope * -over_sigma / distance;
    const Lanes used = value != kNoPixel ? Lanes{} + 1.0F : Lanes{};
    const Lanes slopes[4] = {(rm[0] * qx + rm[2] * qy) * outward,
                             (rm[1] * qx + rm[3] * qy) * outward,
                             share,
                             1.0F - share};
    lanes.add(slopes, value - constants.black, used);
  }
  lanes.writeTo(sums);
}

namespace {

// The model at eight pixels: its slopes by all unknowns, residuals and weights.
template <typename Use>
LAB_INLINE void eachGroup(const Window& window, const Constants& constants, const Disc& disc,
                          float cutoff, LaneCounts& counts, const Use& use) {
  const float over_sigma = 1.0F / disc.sigma;
  const float over_cutoff = 1.0F / (cutoff * cutoff);
  const float contrast = 1.0F - disc.ratio;
  const float outline = constants.radius * disc.scale;
  for (int at = 0; at < window.count; at += kLanes) {
    const Lanes x = loadLanes(window.x + at);
    const Lanes y = loadLanes(window.y + at);
    const Lanes value = loadLanes(window.value + at);
    Paint paint;
    paintAt(x, y, disc, constants.rm, outline, over_sigma, paint);
    const Lanes white = disc.white + disc.slope_x * x + disc.slope_y * y;
    const Lanes lightness = disc.ratio + contrast * paint.share;
    Lanes residual;
    Lanes weight;
    weigh(value, white * lightness, constants, over_cutoff, counts, residual, weight);

    const Lanes rise = white * paint.slope * (contrast * over_sigma);
    const Lanes outward = rise * paint.over_distance;
    const Lanes slopes[kUnknowns] = {-paint.out_x * outward,
                                     -paint.out_y * outward,
                                     lightness * x,
                                     lightness * y,
                                     lightness,
                                     rise * (-constants.radius),
                                     white * (1.0F - paint.share),
                                     rise * (disc.sigma * paint.over_distance - paint.z)};
    use(at, slopes, white, residual, weight);
  }
}

}  // namespace

__attribute__((target_clones("avx2", "default")))
void sumBlocks(const Window& window, const Constants& constants, const Disc& disc, float cutoff,
               Blocks& blocks) {
  LaneSums<kBlock> odd;
  LaneSums<kBlock> even;
  LaneCounts counts;
  eachGroup(window, constants, disc, cutoff, counts,
            [&](int, const Lanes* slopes, const Lanes&, const Lanes& residual,
                const Lanes& weight)
                LAB_INLINE_LAMBDA {
                  odd.add(slopes, residual, weight);
                  even.add(slopes + kBlock, residual, weight);
                });
  Sums<kBlock> sums;
  odd.writeTo(sums);
  blocks.odd = sums.normal;
  for (std::size_t i = 0; i < kBlock; ++i) blocks.right.right[i] = sums.right[i];
  blocks.right.squares = sums.squares;
  even.writeTo(sums);
  blocks.even = sums.normal;
  for (std::size_t i = 0; i < kBlock; ++i) blocks.right.right[kBlock + i] = sums.right[i];
  counts.writeTo(blocks.right.counts);
}

__attribute__((target_clones("avx2", "default")))
void sumRight(const Window& window, const Constants& constants, const Disc& disc, float cutoff,
              Right& right) {
  LaneCounts counts;
  Lanes sums[kUnknowns] = {};
  Lanes squares = {};
  eachGroup(window, constants, disc, cutoff, counts,
            [&](int, const Lanes* slopes, const Lanes&, const Lanes& residual,
                const Lanes& weight)
                LAB_INLINE_LAMBDA {
                  const Lanes weighted = residual * weight;
#pragma GCC unroll 16
                  for (std::size_t i = 0; i < kUnknowns; ++i) sums[i] += slopes[i] * weighted;
                  squares += residual * weighted;
                });
  for (std::size_t i = 0; i < kUnknowns; ++i) right.right[i] = total(sums[i]);
  right.squares = total(squares);
  counts.writeTo(right.counts);
}

__attribute__((target_clones("avx2", "default")))
void sumLast(Window& window, const Constants& constants, const Disc& disc, float cutoff,
             const BlockRow& row_x, const BlockRow& row_y, LastStep& last) {
  float to_x[kBlock];
  float to_y[kBlock];
  for (std::size_t i = 0; i < kBlock; ++i) {
    to_x[i] = static_cast<float>(row_x[i]);
    to_y[i] = static_cast<float>(row_y[i]);
  }
  LaneCounts counts;
  Lanes x = {};
  Lanes y = {};
  Lanes xx = {};
  Lanes xy = {};
  Lanes yy = {};
  Lanes squares = {};
  eachGroup(window, constants, disc, cutoff, counts,
            [&](int at, const Lanes* slopes, const Lanes& white, const Lanes& residual,
                const Lanes& weight) LAB_INLINE_LAMBDA {
              const Lanes weighted = residual * weight;
              Lanes pull_x = to_x[0] * slopes[0];
              Lanes pull_y = to_y[0] * slopes[0];
#pragma GCC unroll 16
              for (std::size_t i = 1; i < kBlock; ++i) {
                pull_x += to_x[i] * slopes[i];
                pull_y += to_y[i] * slopes[i];
              }
              pull_x *= weighted;
              pull_y *= weighted;
              x += pull_x;
              y += pull_y;
              xx += pull_x * pull_x;
              xy += pull_x * pull_y;
              yy += pull_y * pull_y;
              squares += weighted * residual;
              storeLanes(window.residual + at, weighted);
              storeLanes(window.light + at, white);
            });
  last.x = total(x);
  last.y = total(y);
  last.variance = {total(xx), total(xy), total(yy)};
  last.squares = total(squares);
  counts.writeTo(last.counts);
  last.counts.cost = total(counts.cost);
}

__attribute__((target_clones("avx2", "default")))
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

}  // namespace lab::tracker::fit
