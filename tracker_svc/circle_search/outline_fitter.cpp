#include "tracker_svc/circle_search/outline_fitter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

#include "light/field/target_clones.hpp"

namespace lab::detector {
namespace {

constexpr float kLongSide = 1.1F;  // [big radii] to both sides: elongated
constexpr float kThin = 0.4F;      // [big diameters] an object narrower than this,
// [1] and longer than its width by this factor, is a line or the side of a body
constexpr float kManyTimes = 2.4F;
// the outline is where the brightness rises by 1 / 5 of the contrast
constexpr int kLevelShare = 5;
// [softness] distance of that level inside the half-way level, per share of the contrast
constexpr float kSlopePerShare = 2.8F;
// [1] of the geometric mean of both radii; the inverse for big
constexpr float kSurelySmall = 0.85F;
constexpr float kBlackShare = 0.08F;  // [1] reflectance of black paint over that of white
constexpr float kMostOval = 0.2F;     // [1] difference between the longest and the shortest radius
constexpr float kLeastSize = 0.72F;   // [1] of the expected diameter
constexpr float kMostSize = 1.32F;
constexpr int kLeastOutlines = 11;       // of 16 directions
constexpr float kLeastContrast = 0.28F;  // [1] (bright - dark) / (bright + dark) across an outline
// [1] weight reduction of an outline at the largest distance from the expected one
constexpr float kPrior = 0.4F;
constexpr int kLeastAtFirst = 9;
constexpr int kLeastOnAxes = 5;  // of the first 8 directions
constexpr int kCentreSteps = 3;
constexpr int kWeighSteps = 8;
constexpr int kLanes = 8;  // directions processed in parallel

using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));

/// Position of the largest contrast along eight directions.
struct Outlines {
  float at[kLanes];        // [samples]
  float contrast[kLanes];  // [1] times the prior
  float white[kLanes];     // [DN]
};

/// @param rays [bytes] to one sample in each direction; the next samples are `skip` later
/// @param prior by sample
/// @param softer [DN] added to the brightness that the contrast is divided by
LAB_TARGET_CLONES void lookAlong(const std::uint8_t* middle, const std::int32_t* rays, int skip,
                                 int samples, const float* prior, float softer,
                                 Outlines& outlines) {
  std::int32_t pixels[kRaySamples][kLanes];
  for (int i = 0; i < samples; ++i, rays += skip) {
    for (int k = 0; k < kLanes; ++k) pixels[i][k] = middle[rays[k]];
  }
  Floats along[4];  // the last four samples
  for (int i = 0; i < 4; ++i) {
    Ints there;
    std::memcpy(&there, pixels[i], sizeof there);
    along[i] = __builtin_convertvector(there, Floats);
  }
  // Compares ratios by cross-multiplication, to avoid a division per sample.
  Floats best{};
  Floats best_sum = Floats{} + 1;
  Ints best_at{};
  Floats white{};
  for (int i = 4; i < samples; ++i) {
    Ints there;
    std::memcpy(&there, pixels[i], sizeof there);
    const Floats last = __builtin_convertvector(there, Floats);
    const Floats outer = last + along[3];
    const Floats inner = along[0] + along[1];
    const Floats difference = (outer - inner) * prior[i];
    const Floats sum = outer + inner + softer;
    const Ints better = difference * best_sum > best * sum;
    best = better ? difference : best;
    best_sum = better ? sum : best_sum;
    best_at = better ? Ints{} + i : best_at;
    white = better ? last : white;
    along[0] = along[1];
    along[1] = along[2];
    along[2] = along[3];
    along[3] = last;
  }
  const Floats contrast = best / best_sum;
  const Floats at = __builtin_convertvector(best_at, Floats);
  std::memcpy(outlines.at, &at, sizeof at);
  std::memcpy(outlines.contrast, &contrast, sizeof contrast);
  std::memcpy(outlines.white, &white, sizeof white);
}

/// Half the chord of a circle at a distance from its centre; -1 if there is none.
int halfWidth(float square, int distance) {
  const float rest = square - static_cast<float>(distance * distance);
  return rest < 0 ? -1 : static_cast<int>(std::sqrt(rest));
}

/// Sums over a disc, and over the ring between it and a larger disc.
struct Sums {
  int inside = 0;  // [DN]
  int inside_count = 0;
  int moment_x = 0;  // [DN px] first moment of the disc
  int moment_y = 0;
  int rim = 0;  // [DN]
  int rim_count = 0;
};

Sums sumAround(const std::uint8_t* middle, std::ptrdiff_t stride, float inner, int outer) {
  Sums sums;
  for (int dy = -outer; dy <= outer; ++dy) {
    const std::uint8_t* row = middle + dy * stride;
    const int far = halfWidth(static_cast<float>(outer * outer), dy);
    const int near = halfWidth(inner * inner, dy);
    int all = 0;
    for (int dx = -far; dx <= far; ++dx) all += row[dx];
    int inside = 0;
    int moment = 0;
    for (int dx = -near; dx <= near; ++dx) {
      inside += row[dx];
      moment += dx * row[dx];
    }
    const int inside_count = near < 0 ? 0 : 2 * near + 1;
    sums.inside += inside;
    sums.inside_count += inside_count;
    sums.moment_x += moment;
    sums.moment_y += dy * inside;
    sums.rim += all - inside;
    sums.rim_count += 2 * far + 1 - inside_count;
  }
  return sums;
}

// Opposite directions one after the other, the four axes first: most clutter is rejected by these.
constexpr int kOrder[kRayDirections] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};

}  // namespace

OutlineFitter::OutlineFitter(const optics::Imaging& imaging, const GreyLevels& levels)
    : read_noise_(static_cast<float>(imaging.read_noise)),
      levels_(levels),
      softness_(static_cast<float>(std::sqrt(imaging.blur * imaging.blur + optics::kPixelBox))) {
  for (std::size_t i = 0; i < kRayDirections; ++i) {
    const double angle = 2 * std::numbers::pi * kOrder[i] / kRayDirections;
    cos_[i] = static_cast<float>(std::cos(angle));
    sin_[i] = static_cast<float>(std::sin(angle));
  }
}

void OutlineFitter::aim(Plane& plane, const optics::GreyView& view) const {
  const bool same = plane.view.stride == view.stride && !plane.rays.empty();
  plane.view = view;
  if (same) return;
  plane.rays.clear();
  for (int r = 0; r < kRaySamples; ++r) {
    for (std::size_t k = 0; k < kRayDirections; ++k) {
      const long dx = std::lround(static_cast<float>(r) * cos_[k]);
      const long dy = std::lround(static_cast<float>(r) * sin_[k]);
      plane.rays.push_back(static_cast<std::int32_t>(dy * view.stride + dx));
    }
  }
}

bool OutlineFitter::weigh(const Plane& plane, const Candidate& candidate, int reach,
                          Spot& spot) const {
  const Sizes& sizes = candidate.sizes;
  const float inner = sizes.big + softness_;
  const int outer = std::max<int>(candidate.to.across, static_cast<int>(inner + 2));
  const auto black = static_cast<float>(levels_.black);
  const float least =
      kLeastSize * kLeastSize * std::numbers::pi_v<float> * sizes.small * sizes.small;
  auto x = static_cast<float>(candidate.x);
  auto y = static_cast<float>(candidate.y);
  float white = 0;
  float area = 0;
  bool still = false;
  for (int step = 0; step < kWeighSteps && !still; ++step) {
    const int cx = static_cast<int>(std::lround(x));
    const int cy = static_cast<int>(std::lround(y));
    const int moved = std::max(std::abs(cx - candidate.x), std::abs(cy - candidate.y));
    if (moved + outer > reach) return false;
    const Sums sums = sumAround(plane.view.row(cy) + cx, plane.view.stride, inner, outer);
    if (sums.rim_count == 0) return false;
    white = static_cast<float>(sums.rim) / static_cast<float>(sums.rim_count) - black;
    const float contrast = (1 - kBlackShare) * white;
    if (contrast < static_cast<float>(levels_.noise) / 2) return false;
    area = ((white + black) * static_cast<float>(sums.inside_count) -
            static_cast<float>(sums.inside)) /
           contrast;
    const float most = 0.6F * sizes.big;
    const float dark = contrast * std::max(area, least);
    const float shift_x = std::clamp(-static_cast<float>(sums.moment_x) / dark, -most, most);
    const float shift_y = std::clamp(-static_cast<float>(sums.moment_y) / dark, -most, most);
    still = std::abs(shift_x) < 0.75F && std::abs(shift_y) < 0.75F;
    x = static_cast<float>(cx) + shift_x;
    y = static_cast<float>(cy) + shift_y;
  }
  if (!still || area < least) return false;
  const float size = std::sqrt(area / std::numbers::pi_v<float>);
  if (size > kMostSize * sizes.big) return false;
  const float between = std::sqrt(sizes.big * sizes.small);
  spot = {x, y, white, size > between * kSurelySmall, size < between / kSurelySmall, size};
  return true;
}

bool OutlineFitter::settle(const Plane& plane, const Candidate& candidate, Spot& spot,
                           std::vector<RejectedSpot>* rejected) const {
  const auto x = static_cast<float>(candidate.x);
  const auto y = static_cast<float>(candidate.y);
  Spot big;
  Spot small;
  const int as_big = centre(plane, x, y, candidate.sizes.big, big);
  const int as_small =
      as_big < kRayDirections ? centre(plane, x, y, candidate.sizes.small, small) : 0;
  const int most = std::max(as_big, as_small);
  if (most < kLeastOutlines) {
    if (rejected != nullptr && most > kRayDirections / 2) {
      rejected->push_back({x, y, static_cast<float>(most) / kRayDirections,
                           static_cast<float>(kLeastOutlines) / kRayDirections});
    }
    return false;
  }
  spot = as_big >= as_small ? big : small;
  spot.size = as_big >= as_small ? candidate.sizes.big : candidate.sizes.small;
  // With light edges the visible outline does not determine the size; both sizes are fitted.
  spot.can_be_big = true;
  spot.can_be_small = true;
  return true;
}

Shape OutlineFitter::shapeAround(const Plane& plane, const Candidate& candidate, Spot& spot) const {
  constexpr int kAxes = 4;
  constexpr int kStepX[kAxes] = {1, 0, 1, 1};
  constexpr int kStepY[kAxes] = {0, 1, 1, -1};
  constexpr float kLength[kAxes] = {1, 1, std::numbers::sqrt2_v<float>,
                                    std::numbers::sqrt2_v<float>};
  const Sizes& sizes = candidate.sizes;
  const std::uint8_t* start = plane.view.row(candidate.y) + candidate.x;
  // A low level, so that the dim side of a light edge still counts as white, but above the noise.
  const int contrast = candidate.white - candidate.dark;
  const int level =
      candidate.dark + std::max(contrast / kLevelShare, std::min(contrast / 2, levels_.noise));
  const float share = static_cast<float>(level - candidate.dark) / static_cast<float>(contrast);
  const float inside = (0.5F - share) * kSlopePerShare * softness_;
  const float longest = 2 * sizes.big * kMostSize + 1;
  const float reach = longest + 1;
  // Distance from the start to where the picture crosses the level; `reach` if it does not.
  const auto walk = [&](int dx, int dy, float length) {
    const int most = static_cast<int>(reach / length);
    const std::ptrdiff_t to = dy * plane.view.stride + dx;
    const std::uint8_t* at = start;
    for (int i = 1; i <= most; ++i) {
      const int before = *at;
      at += to;
      if (*at >= level) {
        return length * (static_cast<float>(i) -
                         static_cast<float>(*at - level) / static_cast<float>(*at - before));
      }
    }
    return reach;
  };
  float half[kAxes];
  float shift[kAxes];
  bool open = false;
  float shortest = reach;
  float widest = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    const float ahead = walk(kStepX[axis], kStepY[axis], kLength[axis]);
    const float behind = walk(-kStepX[axis], -kStepY[axis], kLength[axis]);
    // Long to one side only may be the dim side of a light edge.
    if (ahead + behind > longest && std::min(ahead, behind) > kLongSide * sizes.big) {
      return Shape::kLong;
    }
    open = open || ahead >= reach || behind >= reach;
    shortest = std::min(shortest, ahead + behind);
    widest = std::max(widest, ahead + behind);
    if (shortest < kThin * 2 * sizes.big && widest > kManyTimes * shortest) return Shape::kThin;
    half[axis] = (ahead + behind) / 2;
    shift[axis] = (ahead - behind) / 2;
  }
  if (open) return Shape::kOther;
  // The middle of a chord is the foot of the perpendicular from the centre.
  const float diagonal = std::numbers::sqrt2_v<float> / 2;
  const float cx = (shift[0] + diagonal * (shift[2] + shift[3])) / 2;
  const float cy = (shift[1] + diagonal * (shift[2] - shift[3])) / 2;
  float least = 1e9F;
  float most = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    const float side =
        (cx * static_cast<float>(kStepY[axis]) - cy * static_cast<float>(kStepX[axis])) /
        kLength[axis];
    const float square = half[axis] * half[axis] + side * side;
    least = std::min(least, square);
    most = std::max(most, square);
  }
  const float size = std::sqrt(std::sqrt(least * most)) + inside;
  if (std::sqrt(most) - std::sqrt(least) > kMostOval * size + 0.6F) return Shape::kOther;
  spot.x = static_cast<float>(candidate.x) + cx;
  spot.y = static_cast<float>(candidate.y) + cy;
  const float between = std::sqrt(sizes.big * sizes.small);
  spot.can_be_big = size > between * kSurelySmall;
  spot.can_be_small = size < between / kSurelySmall;
  spot.white = static_cast<float>(candidate.white - levels_.black);
  spot.size = size;
  const bool fits = size > kLeastSize * sizes.small && size < kMostSize * sizes.big;
  return fits ? Shape::kRound : Shape::kOther;
}

OutlineFitter::Ring OutlineFitter::lookAround(const Plane& plane, float x, float y, float radius,
                                              float slack) const {
  Ring ring;
  const int from = std::max(0, static_cast<int>(radius - slack - 2));
  const int samples =
      std::min(kRaySamples - from, static_cast<int>(std::ceil(radius + slack + 2)) - from + 1);
  const float softer = 4 * read_noise_ - 4 * static_cast<float>(levels_.black);
  float prior[kRaySamples];
  for (int i = 0; i < samples; ++i) {
    const float off = (static_cast<float>(from + i - 2) - radius) / (slack + 1);
    prior[i] = 1 - kPrior * off * off;
  }
  // The rays start at the centre of a pixel.
  const int middle_x = static_cast<int>(x + 0.5F);
  const int middle_y = static_cast<int>(y + 0.5F);
  const std::uint8_t* middle = plane.view.row(middle_y) + middle_x;
  float cc = 0;
  float cs = 0;
  float ss = 0;
  float ce = 0;
  float se = 0;
  float white = 0;
  for (std::size_t first = 0; first < kRayDirections; first += kLanes) {
    Outlines outlines;
    const std::size_t ray = static_cast<std::size_t>(from) * kRayDirections + first;
    lookAlong(middle, plane.rays.data() + ray, kRayDirections, samples, prior, softer, outlines);
    bool missing = false;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t k = first + i;
      const float error = static_cast<float>(from - 2) + outlines.at[i] - radius;
      const bool before = missing;
      missing = outlines.contrast[i] < kLeastContrast || std::abs(error) > slack;
      if (missing) {
        if (i % 2 == 1 && before) ++ring.open;
        continue;
      }
      ++ring.outlines;
      cc += cos_[k] * cos_[k];
      cs += cos_[k] * sin_[k];
      ss += sin_[k] * sin_[k];
      ce += cos_[k] * error;
      se += sin_[k] * error;
      white += outlines.white[i];
    }
    if (ring.open > 0 || (first == 0 && ring.outlines < kLeastOnAxes)) return ring;
  }
  const float determinant = cc * ss - cs * cs;
  if (ring.outlines < 4 || determinant < 1) return ring;
  ring.dx = static_cast<float>(middle_x) - x + (ss * ce - cs * se) / determinant;
  ring.dy = static_cast<float>(middle_y) - y + (cc * se - cs * ce) / determinant;
  ring.white = white / static_cast<float>(ring.outlines) - static_cast<float>(levels_.black);
  return ring;
}

int OutlineFitter::centre(const Plane& plane, float x, float y, float radius, Spot& spot) const {
  float slack = 0.65F * radius + 0.5F;
  Ring ring;
  const float begin_x = x;
  const float begin_y = y;
  for (int step = 0; step < kCentreSteps; ++step) {
    ring = lookAround(plane, x, y, radius, slack);
    if (ring.outlines < kLeastAtFirst + step || ring.open > 0) return 0;
    x += std::clamp(ring.dx, -slack, slack);
    y += std::clamp(ring.dy, -slack, slack);
    if (std::hypot(x - begin_x, y - begin_y) > radius) return 0;
    slack = step == 0 ? 0.45F * radius + 0.5F : 0.25F * radius + 0.5F;
  }
  ring = lookAround(plane, x, y, radius, slack);
  spot.x = x;
  spot.y = y;
  spot.white = ring.white;
  // Open to both sides: elongated. A light edge removes the outline on one side only.
  return ring.open == 0 ? ring.outlines : 0;
}

std::optional<Spot> OutlineFitter::centredAt(const Plane& plane, float x, float y,
                                             float radius) const {
  Spot spot;
  if (centre(plane, x, y, radius, spot) < kLeastOutlines) return std::nullopt;
  return spot;
}

}  // namespace lab::detector
