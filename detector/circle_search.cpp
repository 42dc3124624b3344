#include "detector/circle_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

namespace lab::detector {
namespace {

constexpr double kToNeighbour = 1.25;  // [big radii] outside of both circles, inside the cap
constexpr double kRowsPerRadius = 0.8;  // of the small circle, between tested rows
constexpr double kReach = 2.65;        // [big radii] from a candidate to the farthest pixel, and
constexpr double kReachMore = 5;       // [px] on top
constexpr float kSigmas = 3.3F;        // of read noise that no candidate is made of
constexpr float kJunk = 0.9F;          // [big radii] around it in which nothing else is looked at
constexpr int kStandOut = 3;           // [noise / 4] of means around over means inside
constexpr int kLine = 64;              // [bytes] that come from memory together
constexpr int kAhead = 4;              // [tested rows] that are asked for before they are needed
constexpr int kBits = 64;
// Opposite directions one after the other, the four axes first: junk is soon known for it.
constexpr int kOrder[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};

}  // namespace

CircleSearch::CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
                           const optics::Imaging& imaging, int width, int height)
    : imaging_(imaging) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * kOrder[i] / kDirections;
    cos_[i] = static_cast<float>(std::cos(angle));
    sin_[i] = static_cast<float>(std::sin(angle));
  }
  black_ = std::clamp(static_cast<int>(std::lround(imaging.black)), 0, 100);
  noise_ = std::clamp(static_cast<int>(std::ceil(kSigmas * static_cast<float>(imaging.read_noise))),
                      1, 100);
  levels_ = levelsOf(black_, noise_);
  softness_ = static_cast<float>(std::sqrt(imaging.blur * imaging.blur + optics::kPixelBox));
  if (scale.largest() <= 0 || width <= kWord || height < 1) return;
  const double small = cap.small_radius * static_cast<double>(scale.smallest());
  const double big = cap.big_radius * static_cast<double>(scale.largest());
  step_ = std::max(1, static_cast<int>(std::lround(kRowsPerRadius * small)));
  reach_ = static_cast<int>(std::ceil(kReach * big + kReachMore));
  padding_ = (reach_ + kWord - 1) / kWord * kWord;
  width_ = width + 2 * padding_;
  height_ = height + 2 * padding_;
  for (int x = 0; x + kWord <= width; x += kWord) word_starts_.push_back(padding_ + x);
  const int last = padding_ + width - kWord;
  if (word_starts_.back() < last) word_starts_.push_back(last);
  const std::size_t blocks = (word_starts_.size() + kBits - 1) / kBits;
  addSizes(scale, cap);
  for (const Neighbours& to : neighbours_) near_ = std::max<int>(near_, to.across);
  edge_words_.assign(blocks, 0);
  std::vector<int> starts;
  for (std::size_t i = 0; i < word_starts_.size(); ++i) {
    const int start = word_starts_[i];
    starts.push_back(start - padding_);
    const bool inside = start - near_ >= padding_ && start + kWord + near_ <= width_ - padding_;
    if (!inside) edge_words_[i / kBits] |= std::uint64_t{1} << (i % kBits);
  }
  glance_ = FirstGlance(width, height, starts, (step_ - padding_ % step_) % step_, step_, near_);
  claims_ = ClaimMap(width_, height_);
  dark_.resize(2 * kBits);
  marks_.assign(static_cast<std::size_t>(height_) * blocks, 0);
}

void CircleSearch::addSizes(const ScaleMap& scale, const optics::CapGeometry& cap) {
  const int margin = reach_ / 2;
  for (int y = 0; y < height_; y += kBand) {
    for (const int x : word_starts_) {
      const LocalScale there =
          scale.at(x + kWord / 2 - padding_,
                   std::clamp(y + kBand / 2 - padding_, 0, height_ - 2 * padding_ - 1));
      Sizes sizes;
      Neighbours to;
      if (there.mean > 0) {
        sizes.big = static_cast<float>(cap.big_radius) * there.mean;
        sizes.small = static_cast<float>(cap.small_radius) * there.mean;
        to.near = static_cast<std::int16_t>(std::max<long>(std::lround(sizes.small / 2), 1));
        const double across = kToNeighbour * static_cast<double>(sizes.big);
        to.across = static_cast<std::int16_t>(std::clamp<long>(std::lround(across), 1, margin));
        to.diagonal = static_cast<std::int16_t>(
            std::clamp<long>(std::lround(across / std::numbers::sqrt2), 1, margin));
      }
      sizes_.push_back(sizes);
      neighbours_.push_back(to);
    }
  }
}

void CircleSearch::find(const optics::GreyView& picture, std::span<const Region> regions,
                        std::vector<Spot>& spots, std::vector<Refused>* refused) {
  findRound(picture, regions, spots, refused);
  findRest(spots, refused);
}

void CircleSearch::findRound(const optics::GreyView& picture, std::span<const Region> regions,
                             std::vector<Spot>& spots, std::vector<Refused>* refused) {
  spots.clear();
  rest_.clear();
  if (word_starts_.empty()) return;
  spots_ = &spots;
  refused_ = refused;
  claims_.forget();
  aimAt(picture);
  aim(edges_, padded_.begin(picture, padding_));
  std::fill(marks_.begin(), marks_.end(), 0);
  int top = picture.height;
  int bottom = 0;
  for (const Region& region : regions) {
    mark(picture, region);
    top = std::min(top, std::max(region.top, 0));
    bottom = std::max(bottom, std::min(region.bottom, picture.height - 1));
  }
  if (top > bottom) return;
  glance_.look(picture, levels_, top, bottom);
  const int last = bottom + padding_;
  for (int y = top + padding_; y <= last; ++y) {
    // In little light single pixels say less: more of them.
    if (y % step_ != 0 && !glance_.anyFaint(y - padding_)) continue;
    testRow(y, std::min(kAhead * step_, last - y) * picture.stride);
  }
  bringBack(spots, 0);
}

void CircleSearch::findRest(std::vector<Spot>& spots, std::vector<Refused>* refused) {
  const std::size_t first = spots.size();
  spots_ = &spots;
  refused_ = refused;
  for (const Candidate& candidate : rest_) {
    if (claims_.isCovered(candidate.x, candidate.y)) continue;
    const auto x = static_cast<float>(candidate.x);
    if (isClaimed(x, static_cast<float>(candidate.y), candidate.dark)) continue;
    take(candidate);
  }
  rest_.clear();
  bringBack(spots, first);
  if (refused == nullptr) return;
  for (Refused& one : *refused) {
    one.x -= static_cast<float>(padding_);
    one.y -= static_cast<float>(padding_);
  }
}

// From the coordinates of the padded picture to those of the picture.
void CircleSearch::bringBack(std::vector<Spot>& spots, std::size_t first) const {
  const auto back = static_cast<float>(padding_);
  const auto outside = [&](Spot& spot) {
    spot.x -= back;
    spot.y -= back;
    const auto right = static_cast<float>(width_ - 2 * padding_ - 1);
    const auto bottom = static_cast<float>(height_ - 2 * padding_ - 1);
    return !(spot.x >= 0 && spot.y >= 0 && spot.x <= right && spot.y <= bottom);
  };
  spots.erase(std::remove_if(spots.begin() + static_cast<std::ptrdiff_t>(first), spots.end(),
                             outside),
              spots.end());
}

void CircleSearch::cover(double x, double y, double radius) {
  if (word_starts_.empty()) return;
  claims_.cover(static_cast<float>(x + padding_), static_cast<float>(y + padding_),
                static_cast<float>(radius));
}

void CircleSearch::aimAt(const optics::GreyView& picture) {
  aim(inner_, PaddedPicture::within(picture, padding_));
}

std::optional<Spot> CircleSearch::circleAt(optics::Pixel place, bool big) const {
  // [radii] where it is looked for
  constexpr double kAside[9][2] = {{0, 0},     {1, 0},      {-1, 0},     {0, 1},      {0, -1},
                                   {0.7, 0.7}, {-0.7, 0.7}, {0.7, -0.7}, {-0.7, -0.7}};
  if (word_starts_.empty()) return std::nullopt;
  const auto word = std::min(static_cast<std::size_t>(std::max(place.x, 0.0)) / kWord,
                             word_starts_.size() - 1);
  const int middle_y = static_cast<int>(std::lround(place.y)) + padding_;
  if (middle_y < 0 || middle_y >= height_) return std::nullopt;
  const std::size_t at = static_cast<std::size_t>(middle_y) / kBand * word_starts_.size() + word;
  Candidate candidate{.to = neighbours_[at], .sizes = sizes_[at]};
  if (candidate.to.across == 0) return std::nullopt;
  const auto radius = static_cast<double>(big ? candidate.sizes.big : candidate.sizes.small);
  for (const auto& aside : kAside) {
    candidate.x = static_cast<int>(std::lround(place.x + radius * aside[0])) + padding_;
    candidate.y = static_cast<int>(std::lround(place.y + radius * aside[1])) + padding_;
    if (!isInner(candidate.x, candidate.y, reach_)) continue;
    if (!isDark(inner_, candidate)) continue;
    Spot spot;
    if (shapeAround(inner_, candidate, spot) != Shape::kRound) continue;
    if (big ? !spot.can_be_big : !spot.can_be_small) continue;
    spot.x -= static_cast<float>(padding_);
    spot.y -= static_cast<float>(padding_);
    return spot;
  }
  return std::nullopt;
}

void CircleSearch::aim(Plane& plane, const optics::GreyView& view) const {
  const bool same = plane.view.stride == view.stride && !plane.rays.empty();
  plane.view = view;
  if (same) return;
  plane.rays.clear();
  for (int r = 0; r < kMostSamples; ++r) {
    for (std::size_t k = 0; k < kDirections; ++k) {
      const long dx = std::lround(static_cast<float>(r) * cos_[k]);
      const long dy = std::lround(static_cast<float>(r) * sin_[k]);
      plane.rays.push_back(static_cast<std::int32_t>(dy * view.stride + dx));
    }
  }
}

bool CircleSearch::isInner(int x, int y, int around) const {
  const int least = padding_ + around;
  return x >= least && y >= least && x < width_ - least && y < height_ - least;
}

const CircleSearch::Plane& CircleSearch::planeAt(int x, int y, int around) {
  if (isInner(x, y, around)) return inner_;
  padded_.need({x - around, y - around, x + around, y + around});
  return edges_;
}

void CircleSearch::mark(const optics::GreyView& picture, const Region& region) {
  const int left = std::max(region.left, 0);
  const int right = std::min(region.right, picture.width - 1);
  if (left > right) return;
  const auto last_word = static_cast<int>(word_starts_.size()) - 1;
  const int first = std::min(left / kWord, last_word);
  const int last = std::min(right / kWord, last_word);
  const std::size_t blocks = edge_words_.size();
  const int top = std::max(region.top, 0) + padding_;
  const int bottom = std::min(region.bottom, picture.height - 1) + padding_;
  const bool whole = right - left > picture.width / 2;
  for (int block = first / kBits; block <= last / kBits; ++block) {
    const int from = std::max(first - block * kBits, 0);
    const int to = std::min(last - block * kBits, kBits - 1);
    const std::uint64_t bits = ~std::uint64_t{0} >> (kBits - 1 - to + from) << from;
    const auto place = static_cast<std::size_t>(block);
    for (int y = top; y <= bottom; ++y) {
      marks_[static_cast<std::size_t>(y) * blocks + place] |= bits;
    }
  }
  // Scattered places come from memory one after the other unless all are asked for at once.
  for (int y = region.top; y <= region.bottom && !whole; ++y) {
    if (y < 0 || y >= picture.height) continue;
    for (int x = left; x <= right; x += kLine) __builtin_prefetch(picture.row(y) + x);
    __builtin_prefetch(picture.row(y) + right);
  }
}

void CircleSearch::testRow(int y, std::ptrdiff_t ahead) {
  const std::size_t blocks = edge_words_.size();
  const std::uint64_t* marks = marks_.data() + static_cast<std::size_t>(y) * blocks;
  const std::size_t first = static_cast<std::size_t>(y / kBand) * word_starts_.size();
  const bool at_edge = y < padding_ + near_ || y >= height_ - padding_ - near_;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::uint64_t wanted =
        marks[block] & (y % step_ == 0 ? glance_.words(y - padding_, block)
                                       : glance_.faintWords(y - padding_, block));
    if (wanted == 0) continue;
    const std::uint64_t edge = at_edge ? wanted : wanted & edge_words_[block];
    const int* starts = word_starts_.data() + block * kBits;
    const Neighbours* to = neighbours_.data() + first + block * kBits;
    int found = 0;
    if (edge != 0) {
      for (std::uint64_t rest = edge; rest != 0; rest &= rest - 1) {
        const int x = starts[std::countr_zero(rest)];
        padded_.need({x - near_, y - near_, x + kWord + near_, y + near_});
      }
      found = darkWords(edges_.view.row(y), edges_.view.stride, starts, to, edge, 0, levels_,
                        dark_.data());
    }
    if (edge != wanted) {
      found += darkWords(inner_.view.row(y), inner_.view.stride, starts, to, wanted & ~edge,
                         ahead, levels_, dark_.data() + found);
    }
    for (int i = 0; i < found; ++i) {
      DarkWord& word = dark_[static_cast<std::size_t>(i)];
      word.number += static_cast<int>(block) * kBits;
      takeWord(word, y);
    }
  }
}

void CircleSearch::takeWord(const DarkWord& word, int y) {
  const auto number = static_cast<std::size_t>(word.number);
  const std::size_t place = static_cast<std::size_t>(y / kBand) * word_starts_.size() + number;
  Candidate candidate{.y = y, .to = neighbours_[place], .sizes = sizes_[place]};
  std::uint32_t dark = word.dark;
  int done = 0;
  while (dark != 0) {
    const int begin = std::countr_zero(dark);
    const int length = std::countr_one(dark >> begin);
    const int middle = done + begin + (length - 1) / 2;
    candidate.x = word_starts_[number] + middle;
    candidate.white = word.white[middle];
    candidate.dark = inner_.view.row(y)[candidate.x];
    if (!isClaimed(static_cast<float>(candidate.x), static_cast<float>(y), candidate.dark)) {
      if (!takeRound(candidate)) rest_.push_back(candidate);
    }
    const int end = begin + length;
    dark = end < kWord ? dark >> end : 0;
    done += end;
  }
}

bool CircleSearch::takeRound(const Candidate& candidate) {
  Spot spot;
  if (candidate.white - candidate.dark < kFaint * noise_ ||
      !isRound(planeAt(candidate.x, candidate.y, near_), candidate) ||
      shapeAround(planeAt(candidate.x, candidate.y, reach_), candidate, spot) != Shape::kRound) {
    return false;
  }
  if (!isClaimed(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
  return true;
}

bool CircleSearch::isRound(const Plane& plane, const Candidate& candidate) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t near = candidate.to.near;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  const int level = (candidate.dark + candidate.white) / 2;
  int inside = 0;
  for (const std::ptrdiff_t to : {near, near * stride}) {
    inside = std::max<int>(inside, std::max(at[to], at[-to]));
  }
  int outside = 255;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outside = std::min<int>(outside, std::min(at[to], at[-to]));
  }
  return inside < level && level < outside;
}

void CircleSearch::take(const Candidate& candidate) {
  const Plane& plane = planeAt(candidate.x, candidate.y, reach_);
  const bool faint = candidate.white - candidate.dark < kFaint * noise_;
  if (faint && !standsOut(plane, candidate, noise_)) return;
  Spot spot;
  const Shape shape = shapeAround(plane, candidate, spot);
  if (shape == Shape::kLong) {
    // The next rows would only say the same again.
    claims_.claim(static_cast<float>(candidate.x), static_cast<float>(candidate.y),
                  kJunk * candidate.sizes.big, candidate.dark - black_);
    return;
  }
  if (shape == Shape::kThin) return;
  if (faint) {
    if (!weigh(plane, candidate, spot)) return;
  } else if (shape == Shape::kOther && !settle(plane, candidate, spot)) {
    return;
  }
  if (!isClaimed(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
}

void CircleSearch::add(Spot spot, const Sizes& sizes) {
  spots_->push_back(spot);
  claims_.claim(spot.x, spot.y, (spot.can_be_big ? sizes.big : sizes.small) + 1, 0);
}

bool CircleSearch::isDark(const Plane& plane, Candidate& candidate) const {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  candidate.dark = at[0];
  candidate.white = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    candidate.white = std::max<int>(candidate.white, std::min(at[to], at[-to]));
  }
  return 2 * (candidate.dark - black_) + noise_ <= candidate.white - black_ &&
         candidate.white - candidate.dark >= kFaint * noise_;
}

bool CircleSearch::standsOut(const Plane& plane, const Candidate& candidate, int noise) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t near = candidate.to.near;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  const int inner = at[0] + at[near] + at[-near] + at[near * stride] + at[-near * stride];
  int outer = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outer += at[to] + at[-to];
  }
  // The mean of eight less the mean of five, in units of 1/40 DN.
  return 5 * outer - 8 * inner >= 40 * kStandOut * noise / 4;
}

}  // namespace lab::detector
