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
constexpr float kJunk = 0.9F;          // [big radii] around it in which nothing else is looked at
constexpr int kDarker = 2;             // [1] than something long: a circle in it after all
constexpr int kStandOut = 3;           // [noise / 4] of means around over means inside
constexpr int kFaint = 3;              // [noise] a contrast at which single pixels are no guide

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
/// is not clearly darker than both ends of one pair, or not darker than all eight neighbours.
/// Beside a circle in full light lies white that a light edge has left a seventh of its light, and
/// still is brighter than the circle; something long is as dark as its own continuation.
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
                           const optics::Imaging& imaging, int width, int height, int padding)
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
      const LocalScale there = scale.at(
          std::clamp(x + kWord / 2 - padding, 0, width - 2 * padding - 1),
          std::clamp(y + kBand / 2 - padding, 0, height - 2 * padding - 1));
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
  const bool faint = white - dark < kFaint * noise_;
  if (faint && !standsOut(picture, x, y, sizes)) return;
  Spot spot;
  const Shape shape = shapeAround(picture, x, y, white, sizes, spot);
  if (shape == Shape::kLong) {
    // The next rows would only say the same again.
    remember({static_cast<float>(x), static_cast<float>(y)}, kJunk * sizes.big, dark);
    return;
  }
  if (shape == Shape::kThin) return;
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

bool CircleSearch::standsOut(const optics::GreyView& picture, int x, int y,
                             const Sizes& sizes) const {
  const std::uint8_t* at = picture.row(y) + x;
  const std::ptrdiff_t stride = picture.stride;
  const std::ptrdiff_t near = sizes.near;
  const std::ptrdiff_t across = sizes.across;
  const std::ptrdiff_t diagonal = sizes.diagonal;
  const int inner = at[0] + at[near] + at[-near] + at[near * stride] + at[-near * stride];
  int outer = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outer += at[to] + at[-to];
  }
  // The mean of eight less the mean of five, in units of 1/40 DN.
  return 5 * outer - 8 * inner >= 40 * kStandOut * noise_ / 4;
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
