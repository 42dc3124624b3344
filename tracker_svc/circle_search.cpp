#include "tracker_svc/circle_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

namespace lab::tracker {
namespace {

using Bytes = std::uint8_t __attribute__((vector_size(32)));

constexpr double kToNeighbour = 1.25;  // [big radii] outside of both circles, inside the cap
constexpr double kRowsPerRadius = 0.72;  // of the small circle, between tested rows
constexpr float kSigmas = 3.3F;        // of read noise that no candidate is made of
constexpr float kLongSide = 1.1F;      // [big radii] to both sides: something long
constexpr float kJunk = 0.9F;          // [big radii] around it in which nothing else is looked at
constexpr int kDarker = 2;
constexpr float kThin = 0.4F;          // [big diameters] what is no wider, and
constexpr float kManyTimes = 2.4F;     // [1] so much longer, is the side of a body or a line
constexpr int kLevelShare = 5;         // the outline is taken where this share of white is reached
constexpr float kSlopePerShare = 2.8F; // [softness] of how far inside of the half-way that is
constexpr float kSurelySmall = 0.85F;  // [1] of the mean of both radii, and its inverse for big
constexpr int kAmbiguous = 2;          // directions
constexpr float kBlackShare = 0.08F;   // [1] of the light that black sends back, of white's
constexpr int kFaint = 3;              // [noise] a contrast that a single row of pixels is no guide to
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

/// What a row is tested with [DN]; sums stay within a byte for pixels below `most`.
struct Levels {
  std::uint8_t black = 0;
  std::uint8_t most = 0;    // brighter pixels are in no circle
  std::uint8_t clear = 0;   // added to twice the pixel: clearly darker, whatever the noise
  std::uint8_t barely = 0;  // added to 9/8 of the pixel: darker at all
};

/// Of the words of one row, those with a pixel that is darker than its neighbours in the row and in
/// the column.
/// @param row the picture's row
/// @param across [px] to the neighbours of each word, 0: not to be tested
/// @param words the numbers of the words found
/// @return how many
__attribute__((target_clones("avx2", "default"))) int darkWords(
    const std::uint8_t* row, std::ptrdiff_t stride, const int* starts, const std::int16_t* across,
    int count, const Levels& levels, int* words) {
  const Bytes low = Bytes{} + levels.black;
  const Bytes most = Bytes{} + levels.most;
  const Bytes barely = Bytes{} + levels.barely;
  int found = 0;
  for (int word = 0; word < count; ++word) {
    const std::ptrdiff_t to = across[word];
    if (to == 0) continue;
    const std::uint8_t* at = row + starts[word];
    Bytes here;
    Bytes one;
    Bytes other;
    std::uint64_t four[4];
    std::memcpy(&here, at, sizeof here);
    std::memcpy(&one, at - to, sizeof one);
    std::memcpy(&other, at + to, sizeof other);
    here = here > low ? here : low;
    const Bytes wanted = here + (here >> 3) + barely;
    const Bytes beside = one < other ? one : other;
    const auto dark = (wanted <= beside) & (here < most);
    std::memcpy(four, &dark, sizeof four);
    if ((four[0] | four[1] | four[2] | four[3]) == 0) continue;
    std::memcpy(&one, at - to * stride, sizeof one);
    std::memcpy(&other, at + to * stride, sizeof other);
    const Bytes above = one < other ? one : other;
    const auto darker = dark & (wanted <= above);
    std::memcpy(four, &darker, sizeof four);
    if ((four[0] | four[1] | four[2] | four[3]) != 0) words[found++] = word;
  }
  return found;
}

/// For each of 32 pixels: the darker end of the best of four pairs of neighbours; 0 where the pixel
/// is not clearly darker than both ends of one pair, or not darker than all eight neighbours. Beside
/// a circle in full light lies white that a light edge has left a seventh of its light, and still is
/// brighter than the circle; something long is as dark as its own continuation.
/// @param near [px] to four neighbours that must not be white yet
__attribute__((target_clones("avx2", "default"))) void darkAmong(const std::uint8_t* at,
                                                                 std::ptrdiff_t stride, int across,
                                                                 int diagonal, int near,
                                                                 const Levels& levels,
                                                                 std::uint8_t* white) {
  const std::ptrdiff_t ends[4] = {across, across * stride, diagonal * (stride + 1),
                                  diagonal * (stride - 1)};
  Bytes best{};
  Bytes least = ~Bytes{};
  for (const std::ptrdiff_t end : ends) {
    Bytes one;
    Bytes other;
    std::memcpy(&one, at + end, sizeof one);
    std::memcpy(&other, at - end, sizeof other);
    const Bytes darker = one < other ? one : other;
    best = best > darker ? best : darker;
    least = least < darker ? least : darker;
  }
  // Lines are white again where a circle is still dark.
  Bytes beside{};
  for (const std::ptrdiff_t end : {static_cast<std::ptrdiff_t>(near), near * stride}) {
    Bytes one;
    Bytes other;
    std::memcpy(&one, at + end, sizeof one);
    std::memcpy(&other, at - end, sizeof other);
    const Bytes brighter = one > other ? one : other;
    beside = beside > brighter ? beside : brighter;
  }
  Bytes here;
  std::memcpy(&here, at, sizeof here);
  const Bytes low = Bytes{} + levels.black;
  here = here > low ? here : low;
  const Bytes clear = here + here + levels.clear;
  const Bytes barely = here + (here >> 3) + levels.barely;
  const auto dark = (clear <= best) & (barely <= least) & (here < levels.most) &
                    (beside <= best - (best >> 2));
  const Bytes out = dark ? best : Bytes{};
  std::memcpy(white, &out, sizeof out);
}

/// Pixels p above black b that are clearly darker than white w: 2 (p - b) + noise <= w - b.
Levels levelsOf(int black, int noise) {
  Levels levels;
  levels.black = static_cast<std::uint8_t>(black);
  levels.clear = static_cast<std::uint8_t>(std::max(noise - black, 0));
  levels.barely = static_cast<std::uint8_t>(std::max(noise / 2 - black / 8, 0));
  levels.most = static_cast<std::uint8_t>((255 - levels.clear) / 2);
  return levels;
}

}  // namespace

CircleSearch::CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
                           const optics::Imaging& imaging, int width, int height)
    : imaging_(imaging), width_(width), height_(height) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kDirections;
    cos_[i] = static_cast<float>(std::cos(angle));
    sin_[i] = static_cast<float>(std::sin(angle));
  }
  black_ = std::clamp(static_cast<int>(std::lround(imaging.black)), 0, 100);
  noise_ = std::clamp(static_cast<int>(std::ceil(kSigmas * static_cast<float>(imaging.read_noise))),
                      1, 100);
  softness_ = static_cast<float>(std::sqrt(imaging.blur * imaging.blur + 1.0 / 12));
  const double small = cap.small_radius * static_cast<double>(scale.smallest());
  const double big = cap.big_radius * static_cast<double>(scale.largest());
  step_ = std::max(1, static_cast<int>(std::lround(kRowsPerRadius * small)));
  margin_ = static_cast<int>(std::ceil(kToNeighbour * big)) + 1;
  if (scale.largest() <= 0 || width < 2 * margin_ + kWord || height < 2 * margin_ + 1) return;
  for (int x = margin_; x + kWord + margin_ <= width; x += kWord) word_starts_.push_back(x);
  const int last = width - margin_ - kWord;
  if (word_starts_.back() < last) word_starts_.push_back(last);
  for (int y = 0; y < height; y += kBand) {
    for (const int x : word_starts_) {
      const LocalScale there = scale.at(x + kWord / 2, std::min(y + kBand / 2, height - 1));
      Sizes sizes;
      if (there.mean > 0) {
        sizes.big = static_cast<float>(cap.big_radius) * there.mean;
        sizes.small = static_cast<float>(cap.small_radius) * there.mean;
        sizes.near = static_cast<std::int16_t>(std::max<long>(std::lround(sizes.small / 2), 1));
        const double across = kToNeighbour * static_cast<double>(sizes.big);
        sizes.across = static_cast<std::int16_t>(std::clamp<long>(std::lround(across), 1, margin_));
        sizes.diagonal = static_cast<std::int16_t>(
            std::clamp<long>(std::lround(across / std::numbers::sqrt2), 1, margin_));
      }
      sizes_.push_back(sizes);
    }
  }
  cell_columns_ = width / kCell + 1;
  cells_.assign(static_cast<std::size_t>(cell_columns_) *
                    static_cast<std::size_t>(height / kCell + 1), std::int16_t{-1});
  across_.assign(word_starts_.size(), 0);
  words_.assign(word_starts_.size(), 0);
  marks_.assign(static_cast<std::size_t>(height / step_ + 1) * word_starts_.size(), 0);
}

void CircleSearch::find(const optics::GreyView& picture, std::span<const Region> regions,
                        std::vector<Spot>& spots, std::vector<Refused>* refused) {
  spots.clear();
  if (word_starts_.empty()) return;
  spots_ = &spots;
  refused_ = refused;
  forget();
  int top = height_;
  int bottom = 0;
  for (const Region& region : regions) {
    mark(region);
    top = std::min(top, region.top);
    bottom = std::max(bottom, region.bottom);
  }
  top = std::max(top, margin_);
  bottom = std::min(bottom, height_ - 1 - margin_);
  for (int y = (top + step_ - 1) / step_ * step_; y <= bottom; y += step_) testRow(picture, y);
}

void CircleSearch::mark(const Region& region) {
  int first = 0;
  int last = static_cast<int>(word_starts_.size()) - 1;
  while (first < last && word_starts_[static_cast<std::size_t>(first)] + kWord <= region.left) {
    ++first;
  }
  while (last > first && word_starts_[static_cast<std::size_t>(last)] > region.right) --last;
  const int top = std::max(region.top, margin_);
  const int bottom = std::min(region.bottom, height_ - 1 - margin_);
  for (int y = (top + step_ - 1) / step_ * step_; y <= bottom; y += step_) {
    std::uint8_t* marks = marks_.data() + static_cast<std::size_t>(y / step_) * word_starts_.size();
    std::fill(marks + first, marks + last + 1, std::uint8_t{1});
  }
}

void CircleSearch::testRow(const optics::GreyView& picture, int y) {
  const std::size_t count = word_starts_.size();
  const Sizes* sizes = &sizesAt(y);
  std::uint8_t* marks = marks_.data() + static_cast<std::size_t>(y / step_) * count;
  bool any = false;
  for (std::size_t word = 0; word < count; ++word) {
    across_[word] = marks[word] != 0 ? sizes[word].across : std::int16_t{0};
    any = any || marks[word] != 0;
    marks[word] = 0;
  }
  if (!any) return;
  const int found = darkWords(picture.row(y), picture.stride, word_starts_.data(), across_.data(),
                              static_cast<int>(count), levelsOf(black_, noise_), words_.data());
  for (int i = 0; i < found; ++i) {
    const auto word = static_cast<std::size_t>(words_[static_cast<std::size_t>(i)]);
    takeWord(picture, y, word_starts_[word], sizes[word]);
  }
}

void CircleSearch::takeWord(const optics::GreyView& picture, int y, int x, const Sizes& sizes) {
  std::uint8_t white[kWord];
  darkAmong(picture.row(y) + x, picture.stride, sizes.across, sizes.diagonal, sizes.near,
            levelsOf(black_, noise_), white);
  std::uint64_t four[4];
  std::memcpy(four, white, sizeof four);
  if ((four[0] | four[1] | four[2] | four[3]) == 0) return;
  for (int i = 0; i < kWord;) {
    if (white[i] == 0) {
      ++i;
      continue;
    }
    const int begin = i;
    while (i < kWord && white[i] != 0) ++i;
    const int middle = (begin + i - 1) / 2;
    takeRun(picture, x + middle, y, white[middle], sizes);
  }
}

void CircleSearch::takeRun(const optics::GreyView& picture, int x, int y, int white,
                           const Sizes& sizes) {
  const int dark = picture.row(y)[x];
  if (known(static_cast<float>(x), static_cast<float>(y), dark)) return;
  ++tried_;
  Spot spot;
  const Shape shape = shapeAround(picture, x, y, white, sizes, spot);
  if (shape == Shape::kLong) {
    // The next rows would only say the same again.
    remember({static_cast<float>(x), static_cast<float>(y)}, kJunk * sizes.big, dark);
    return;
  }
  if (shape == Shape::kThin) return;
  const bool faint = white - dark < kFaint * noise_;
  const auto from_x = static_cast<float>(x);
  const auto from_y = static_cast<float>(y);
  if (faint) {
    if (!weigh(picture, from_x, from_y, sizes, spot)) return;
  } else if (shape == Shape::kOther && !settle(picture, from_x, from_y, sizes, spot)) {
    return;
  }
  if (known(spot.x, spot.y, dark)) return;
  spots_->push_back(spot);
  remember(spot, (spot.can_be_big ? sizes.big : sizes.small) + 1, 0);
}

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
  ++hard_;
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
  spot.can_be_big = as_big >= kLeastOutlines && as_big + kAmbiguous >= as_small;
  spot.can_be_small = as_small >= kLeastOutlines && as_small + kAmbiguous >= as_big;
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
    const float side = (cx * static_cast<float>(kStepY[axis]) - cy * static_cast<float>(kStepX[axis])) /
                       kLength[axis];
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

const CircleSearch::Sizes& CircleSearch::sizesAt(int y) const {
  return sizes_[static_cast<std::size_t>(y / kBand) * word_starts_.size()];
}

void CircleSearch::forget() {
  for (const Claim& claim : claims_) {
    for (int j = claim.top; j <= claim.bottom; ++j) {
      for (int i = claim.left; i <= claim.right; ++i) {
        cells_[static_cast<std::size_t>(j * cell_columns_ + i)] = -1;
      }
    }
  }
  claims_.clear();
}

bool CircleSearch::known(float x, float y, int dark) const {
  const int i = static_cast<int>(x) / kCell;
  const int j = static_cast<int>(y) / kCell;
  const int at = cells_[static_cast<std::size_t>(j * cell_columns_ + i)];
  if (at < 0) return false;
  const Claim& claim = claims_[static_cast<std::size_t>(at)];
  const float dx = x - claim.x;
  const float dy = y - claim.y;
  // Something much darker in the middle of something long may be a circle after all.
  const bool darker = kDarker * (dark - black_) + noise_ < claim.dark - black_;
  return !darker && dx * dx + dy * dy < claim.reach * claim.reach;
}

void CircleSearch::remember(const Spot& spot, float radius, int dark) {
  if (claims_.size() >= 32767) return;
  const int rows = height_ / kCell + 1;
  Claim claim{.x = spot.x, .y = spot.y, .reach = radius, .dark = dark};
  claim.left = std::clamp(static_cast<int>(spot.x - claim.reach) / kCell, 0, cell_columns_ - 1);
  claim.right = std::clamp(static_cast<int>(spot.x + claim.reach) / kCell, 0, cell_columns_ - 1);
  claim.top = std::clamp(static_cast<int>(spot.y - claim.reach) / kCell, 0, rows - 1);
  claim.bottom = std::clamp(static_cast<int>(spot.y + claim.reach) / kCell, 0, rows - 1);
  const auto number = static_cast<std::int16_t>(claims_.size());
  claims_.push_back(claim);
  for (int j = claim.top; j <= claim.bottom; ++j) {
    for (int i = claim.left; i <= claim.right; ++i) {
      cells_[static_cast<std::size_t>(j * cell_columns_ + i)] = number;
    }
  }
}

}  // namespace lab::tracker
