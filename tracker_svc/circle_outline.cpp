// What a candidate is: its outline, and its centre.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tracker_svc/circle_search.hpp"

namespace lab::tracker {
namespace {

constexpr float kLongSide = 1.1F;      // [big radii] to both sides: something long
constexpr float kThin = 0.4F;          // [big diameters] what is no wider, and
constexpr float kManyTimes = 2.4F;     // [1] so much longer, is the side of a body or a line
constexpr int kLevelShare = 5;         // the outline is taken where this share of white is reached
constexpr float kSlopePerShare = 2.8F; // [softness] of how far inside of the half-way that is
constexpr float kSurelySmall = 0.85F;  // [1] of the mean of both radii, and its inverse for big
constexpr float kBlackShare = 0.08F;   // [1] of the light that black sends back, of white's
constexpr float kMostOval = 0.2F;      // [1] between the longest and the shortest radius
constexpr float kLeastSize = 0.72F;    // [1] of the expected diameter
constexpr float kMostSize = 1.32F;
constexpr int kLeastOutlines = 11;     // of 16 directions
constexpr float kLeastContrast = 0.28F;  // [1] (bright - dark) / (bright + dark) across an outline
constexpr float kPrior = 0.4F;         // [1] how much less an outline far from the expected counts
constexpr int kLeastAtFirst = 9;
constexpr int kLeastOnAxes = 5;        // of the first 8 directions
constexpr std::size_t kOrder[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
constexpr int kCentreSteps = 3;
constexpr int kWeighSteps = 8;

}  // namespace

bool CircleSearch::weigh(const optics::GreyView& picture, float x, float y, const Sizes& sizes,
                         Spot& spot) const {
  const float inner = sizes.big + softness_;
  const int outer = std::max<int>(sizes.across, static_cast<int>(inner + 2));
  const float inner2 = inner * inner;
  const float outer2 = static_cast<float>(outer * outer);
  const auto black = static_cast<float>(black_);
  const float least =
      kLeastSize * kLeastSize * std::numbers::pi_v<float> * sizes.small * sizes.small;
  float white = 0;
  float area = 0;
  bool still = false;
  for (int step = 0; step < kWeighSteps && !still; ++step) {
    const int cx = static_cast<int>(std::lround(x));
    const int cy = static_cast<int>(std::lround(y));
    if (cx < outer || cy < outer || cx + outer >= width_ || cy + outer >= height_) return false;
    int rim = 0;
    int rim_count = 0;
    int inside = 0;
    int inside_count = 0;
    int moment_x = 0;
    int moment_y = 0;
    for (int dy = -outer; dy <= outer; ++dy) {
      const std::uint8_t* row = picture.row(cy + dy) + cx;
      for (int dx = -outer; dx <= outer; ++dx) {
        const auto square = static_cast<float>(dx * dx + dy * dy);
        if (square > outer2) continue;
        if (square > inner2) {
          rim += row[dx];
          ++rim_count;
        } else {
          inside += row[dx];
          moment_x += dx * row[dx];
          moment_y += dy * row[dx];
          ++inside_count;
        }
      }
    }
    if (rim_count == 0) return false;
    white = static_cast<float>(rim) / static_cast<float>(rim_count) - black;
    const float contrast = (1 - kBlackShare) * white;
    if (contrast < static_cast<float>(noise_) / 2) return false;
    area = ((white + black) * static_cast<float>(inside_count) - static_cast<float>(inside)) /
           contrast;
    const float most = 0.6F * sizes.big;
    const float dark = contrast * std::max(area, least);
    const float shift_x = std::clamp(-static_cast<float>(moment_x) / dark, -most, most);
    const float shift_y = std::clamp(-static_cast<float>(moment_y) / dark, -most, most);
    still = std::abs(shift_x) < 0.75F && std::abs(shift_y) < 0.75F;
    x = static_cast<float>(cx) + shift_x;
    y = static_cast<float>(cy) + shift_y;
  }
  if (!still || area < least) return false;
  const float size = std::sqrt(area / std::numbers::pi_v<float>);
  if (size > kMostSize * sizes.big) return false;
  const float between = std::sqrt(sizes.big * sizes.small);
  spot = {x, y, white, size > between * kSurelySmall, size < between / kSurelySmall};
  return true;
}

bool CircleSearch::settle(const optics::GreyView& picture, float x, float y, const Sizes& sizes,
                          Spot& spot) {
  Spot big;
  Spot small;
  const int as_big = centre(picture, x, y, sizes.big, big);
  const int as_small = centre(picture, x, y, sizes.small, small);
  const int most = std::max(as_big, as_small);
  if (most < kLeastOutlines) {
    if (refused_ != nullptr && most > kDirections / 2) {
      refused_->push_back({x, y, static_cast<float>(most) / kDirections,
                           static_cast<float>(kLeastOutlines) / kDirections});
    }
    return false;
  }
  spot = as_big >= as_small ? big : small;
  // What a light edge leaves of an outline says little about its size; the fit will tell.
  spot.can_be_big = true;
  spot.can_be_small = true;
  return true;
}

CircleSearch::Shape CircleSearch::shapeAround(const optics::GreyView& picture, int x, int y,
                                              int white, const Sizes& sizes, Spot& spot) const {
  constexpr int kAxes = 4;
  constexpr int kStepX[kAxes] = {1, 0, 1, 1};
  constexpr int kStepY[kAxes] = {0, 1, 1, -1};
  constexpr float kLength[kAxes] = {1, 1, std::numbers::sqrt2_v<float>,
                                    std::numbers::sqrt2_v<float>};
  const std::uint8_t* start = picture.row(y) + x;
  // Low, so that the dim side of a light edge still counts as white; no lower than noise allows.
  const int contrast = white - *start;
  const int level = *start + std::max(contrast / kLevelShare, std::min(contrast / 2, noise_));
  const float share = static_cast<float>(level - *start) / static_cast<float>(contrast);
  const float inside = (0.5F - share) * kSlopePerShare * softness_;
  const float longest = 2 * sizes.big * kMostSize + 1;
  const float reach = longest + 1;
  // From the start to where the picture crosses the level; `reach` where it does not.
  const auto walk = [&](int dx, int dy, float length) {
    const int room_x = dx == 0 ? width_ : dx > 0 ? width_ - 1 - x : x;
    const int room_y = dy == 0 ? height_ : dy > 0 ? height_ - 1 - y : y;
    const int most = std::min({static_cast<int>(reach / length), room_x, room_y});
    const std::ptrdiff_t to = dy * picture.stride + dx;
    const std::uint8_t* at = start;
    for (int i = 1; i <= most; ++i) {
      const int before = *at;
      at += to;
      if (*at >= level) {
        return length * (static_cast<float>(i) - static_cast<float>(*at - level) /
                                                     static_cast<float>(*at - before));
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
    half[axis] = (ahead + behind) / 2;
    shift[axis] = (ahead - behind) / 2;
  }
  if (shortest < kThin * 2 * sizes.big && widest > kManyTimes * shortest) return Shape::kThin;
  if (open) return Shape::kOther;
  // A chord's middle is the foot of the perpendicular from the centre.
  const float diagonal = std::numbers::sqrt2_v<float> / 2;
  const float cx = (shift[0] + diagonal * (shift[2] + shift[3])) / 2;
  const float cy = (shift[1] + diagonal * (shift[2] - shift[3])) / 2;
  float least = 1e9F;
  float most = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    const float side = (cx * static_cast<float>(kStepY[axis]) -
                        cy * static_cast<float>(kStepX[axis])) / kLength[axis];
    const float square = half[axis] * half[axis] + side * side;
    least = std::min(least, square);
    most = std::max(most, square);
  }
  const float size = std::sqrt(std::sqrt(least * most)) + inside;
  if (std::sqrt(most) - std::sqrt(least) > kMostOval * size + 0.6F) return Shape::kOther;
  spot.x = static_cast<float>(x) + cx;
  spot.y = static_cast<float>(y) + cy;
  const float between = std::sqrt(sizes.big * sizes.small);
  spot.can_be_big = size > between * kSurelySmall;
  spot.can_be_small = size < between / kSurelySmall;
  spot.white = static_cast<float>(white - black_);
  const bool fits = size > kLeastSize * sizes.small && size < kMostSize * sizes.big;
  return fits ? Shape::kRound : Shape::kOther;
}

CircleSearch::Ring CircleSearch::lookAround(const optics::GreyView& picture, float x, float y,
                                            float radius, float slack) const {
  constexpr int kOne = 1 << 16;
  constexpr int kMostSamples = 48;
  Ring ring;
  const float from = std::max(0.0F, radius - slack - 2);
  const int samples = std::min(kMostSamples, static_cast<int>(radius + slack + 2 - from) + 1);
  const float outer = from + static_cast<float>(samples);
  const auto w = static_cast<float>(width_ - 2);
  const auto h = static_cast<float>(height_ - 2);
  if (x < outer || y < outer || x + outer > w || y + outer > h) return ring;
  const float softer = 4 * static_cast<float>(imaging_.read_noise) -
                       4 * static_cast<float>(black_);
  float prior[kMostSamples];
  for (int i = 0; i < samples; ++i) {
    const float off = (from + static_cast<float>(i - 2) - radius) / (slack + 1);
    prior[i] = 1 - kPrior * off * off;
  }
  unsigned missing = 0;
  int open = 0;
  float cc = 0;
  float cs = 0;
  float ss = 0;
  float ce = 0;
  float se = 0;
  float white = 0;
  for (std::size_t n = 0; n < kDirections; ++n) {
    // Opposite directions one after the other, the four axes first: junk is soon known for it.
    const std::size_t k = kOrder[n];
    if (n == kDirections / 2 && (ring.outlines < kLeastOnAxes || open > 0)) return ring;
    int u = static_cast<int>((x + from * cos_[k] + 0.5F) * kOne);
    int v = static_cast<int>((y + from * sin_[k] + 0.5F) * kOne);
    const int du = static_cast<int>(cos_[k] * kOne);
    const int dv = static_cast<int>(sin_[k] * kOne);
    int along[kMostSamples];
    for (int i = 0; i < samples; ++i, u += du, v += dv) {
      along[i] = picture.row(v >> 16)[u >> 16];
    }
    // The largest contrast, without a division for each sample.
    float best = 0;
    float best_sum = 1;
    int best_at = 0;
    for (int i = 4; i < samples; ++i) {
      const int outer_sum = along[i] + along[i - 1];
      const int inner_sum = along[i - 4] + along[i - 3];
      const float difference = static_cast<float>(outer_sum - inner_sum) * prior[i];
      const float sum = static_cast<float>(outer_sum + inner_sum) + softer;
      if (difference * best_sum > best * sum) {
        best = difference;
        best_sum = sum;
        best_at = i;
      }
    }
    const float error = from + static_cast<float>(best_at - 2) - radius;
    if (best < kLeastContrast * best_sum || std::abs(error) > slack) {
      missing |= 1U << k;
      if (n % 2 == 1 && (missing >> kOrder[n - 1] & 1U) != 0) ++open;
      continue;
    }
    ++ring.outlines;
    cc += cos_[k] * cos_[k];
    cs += cos_[k] * sin_[k];
    ss += sin_[k] * sin_[k];
    ce += cos_[k] * error;
    se += sin_[k] * error;
    white += static_cast<float>(along[best_at]);
  }
  ring.open = open;
  const float determinant = cc * ss - cs * cs;
  if (ring.outlines < 4 || determinant < 1) return ring;
  ring.dx = (ss * ce - cs * se) / determinant;
  ring.dy = (cc * se - cs * ce) / determinant;
  ring.white = white / static_cast<float>(ring.outlines) - static_cast<float>(black_);
  return ring;
}

int CircleSearch::centre(const optics::GreyView& picture, float x, float y, float radius,
                         Spot& spot) const {
  float slack = 0.65F * radius + 0.5F;
  Ring ring;
  const float begin_x = x;
  const float begin_y = y;
  for (int step = 0; step < kCentreSteps; ++step) {
    ring = lookAround(picture, x, y, radius, slack);
    if (ring.outlines < kLeastAtFirst + step || ring.open > 0) return 0;
    x += std::clamp(ring.dx, -slack, slack);
    y += std::clamp(ring.dy, -slack, slack);
    if (std::hypot(x - begin_x, y - begin_y) > radius) return 0;
    slack = step == 0 ? 0.45F * radius + 0.5F : 0.25F * radius + 0.5F;
  }
  ring = lookAround(picture, x, y, radius, slack);
  spot.x = x;
  spot.y = y;
  spot.white = ring.white;
  // Open to both sides: something long. A light edge leaves out one side only.
  return ring.open == 0 ? ring.outlines : 0;
}

std::optional<Spot> CircleSearch::centredAs(const optics::GreyView& picture, const Spot& spot,
                                            bool big) const {
  const int y = std::clamp(static_cast<int>(spot.y), 0, height_ - 1);
  const auto word = std::min(static_cast<std::size_t>(std::max(
                                 0.0F, (spot.x - static_cast<float>(margin_)) / kWord)),
                             word_starts_.size() - 1);
  const Sizes& sizes = (&sizesAt(y))[word];
  Spot out;
  if (sizes.across == 0 ||
      centre(picture, spot.x, spot.y, big ? sizes.big : sizes.small, out) < kLeastOutlines) {
    return std::nullopt;
  }
  out.can_be_big = big;
  out.can_be_small = !big;
  return out;
}

}  // namespace lab::tracker
