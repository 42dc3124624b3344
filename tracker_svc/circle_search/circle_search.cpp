#include "tracker_svc/circle_search/circle_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lab::detector {
namespace {

constexpr double kToNeighbour = 1.3;  // [big radii] to a pixel outside both circles but on the cap
constexpr double kRowsPerRadius = 1.1;  // [small radii] between tested rows
constexpr double kReach = 2.65;         // [big radii] from a candidate to the farthest pixel read,
constexpr double kReachMore = 5;        // [px] plus this
constexpr float kSigmas = 3.3F;         // read noise below which a difference is ignored
constexpr int kLine = 64;               // [bytes] of a cache line
constexpr int kAhead = 4;               // [tested rows] prefetched
constexpr int kBits = 64;
constexpr float kJunk = 0.9F;  // [big radii] around clutter in which nothing else is examined

GreyLevels greyLevelsOf(const optics::Imaging& imaging) {
  GreyLevels levels;
  levels.black = std::clamp(static_cast<int>(std::lround(imaging.black)), 0, 100);
  levels.noise = std::clamp(
      static_cast<int>(std::ceil(kSigmas * static_cast<float>(imaging.read_noise))), 1, 100);
  return levels;
}

}  // namespace

CircleSearch::CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
                           const optics::Imaging& imaging, int width, int height)
    : levels_(greyLevelsOf(imaging)), outline_(imaging, levels_) {
  search_levels_ = levelsOf(levels_.black, levels_.noise);
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
  prefilter_ =
      ContrastPrefilter(width, height, starts, (step_ - padding_ % step_) % step_, step_, near_);
  occupied_ = OccupancyMap(width_, height_);
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
                        std::vector<Spot>& spots, std::vector<RejectedSpot>* rejected) {
  findRound(picture, regions, spots, rejected);
  findRest(Rows::kAll, spots, rejected);
}

void CircleSearch::findRound(const optics::GreyView& picture, std::span<const Region> regions,
                             std::vector<Spot>& spots, std::vector<RejectedSpot>* rejected) {
  spots.clear();
  rest_.clear();
  if (word_starts_.empty()) return;
  spots_ = &spots;
  rejected_spots_ = rejected;
  occupied_.forget();
  aimAt(picture);
  outline_.aim(edges_, padded_.begin(picture, padding_));
  std::fill(marks_.begin(), marks_.end(), 0);
  int top = picture.height;
  int bottom = 0;
  for (const Region& region : regions) {
    mark(picture, region);
    top = std::min(top, std::max(region.top, 0));
    bottom = std::max(bottom, std::min(region.bottom, picture.height - 1));
  }
  first_row_ = top + padding_;
  last_row_ = bottom + padding_;
  if (top > bottom) return;
  prefilter_.look(picture, search_levels_, top, bottom);
  for (int y = first_row_; y <= last_row_; ++y) {
    // In dim light single pixels are less reliable, so more rows are tested.
    if (y % step_ != 0 && !prefilter_.anyFaint(y - padding_)) continue;
    testRow(y, std::min(kAhead * step_, last_row_ - y) * picture.stride);
  }
  bringBack(spots, 0);
}

void CircleSearch::findRest(Rows rows, std::vector<Spot>& spots,
                            std::vector<RejectedSpot>* rejected) {
  const std::size_t first = spots.size();
  spots_ = &spots;
  rejected_spots_ = rejected;
  if (rows == Rows::kAll) testBetween();
  for (const Candidate& candidate : rest_) {
    if (occupied_.isCovered(candidate.x, candidate.y)) continue;
    const auto x = static_cast<float>(candidate.x);
    if (isOccupied(x, static_cast<float>(candidate.y), candidate.dark)) continue;
    examine(candidate);
  }
  rest_.clear();
  bringBack(spots, first);
  if (rejected == nullptr) return;
  for (RejectedSpot& one : *rejected) {
    one.x -= static_cast<float>(padding_);
    one.y -= static_cast<float>(padding_);
  }
}

// Converts from the coordinates of the padded picture to those of the picture.
void CircleSearch::bringBack(std::vector<Spot>& spots, std::size_t first) const {
  const auto back = static_cast<float>(padding_);
  const auto outside = [&](Spot& spot) {
    spot.x -= back;
    spot.y -= back;
    const auto right = static_cast<float>(width_ - 2 * padding_ - 1);
    const auto bottom = static_cast<float>(height_ - 2 * padding_ - 1);
    return !(spot.x >= 0 && spot.y >= 0 && spot.x <= right && spot.y <= bottom);
  };
  spots.erase(
      std::remove_if(spots.begin() + static_cast<std::ptrdiff_t>(first), spots.end(), outside),
      spots.end());
}

void CircleSearch::cover(double x, double y, double radius) {
  if (word_starts_.empty()) return;
  occupied_.cover(static_cast<float>(x + padding_), static_cast<float>(y + padding_),
                  static_cast<float>(radius));
}

void CircleSearch::aimAt(const optics::GreyView& picture) {
  outline_.aim(inner_, PaddedPicture::within(picture, padding_));
}

std::optional<Spot> CircleSearch::circleAt(optics::Pixel place, bool big) const {
  // [radii] offsets of the places that are tried
  constexpr double kAside[9][2] = {{0, 0},     {1, 0},      {-1, 0},     {0, 1},      {0, -1},
                                   {0.7, 0.7}, {-0.7, 0.7}, {0.7, -0.7}, {-0.7, -0.7}};
  if (word_starts_.empty()) return std::nullopt;
  const auto word =
      std::min(static_cast<std::size_t>(std::max(place.x, 0.0)) / kWord, word_starts_.size() - 1);
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
    if (!isDark(inner_, levels_, candidate)) continue;
    Spot spot;
    if (outline_.shapeAround(inner_, candidate, spot) != Shape::kRound) continue;
    if (big ? !spot.can_be_big : !spot.can_be_small) continue;
    spot.x -= static_cast<float>(padding_);
    spot.y -= static_cast<float>(padding_);
    return spot;
  }
  return std::nullopt;
}

bool CircleSearch::isInner(int x, int y, int around) const {
  const int least = padding_ + around;
  return x >= least && y >= least && x < width_ - least && y < height_ - least;
}

const Plane& CircleSearch::planeAt(int x, int y, int around) {
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
  // Prefetching overlaps the memory latencies of scattered places.
  for (int y = region.top; y <= region.bottom && !whole; ++y) {
    if (y < 0 || y >= picture.height) continue;
    for (int x = left; x <= right; x += kLine) __builtin_prefetch(picture.row(y) + x);
    __builtin_prefetch(picture.row(y) + right);
  }
}

void CircleSearch::testRow(int y, std::ptrdiff_t ahead) {
  const std::size_t blocks = edge_words_.size();
  const std::uint64_t* marks = marks_.data() + static_cast<std::size_t>(y) * blocks;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::uint64_t may = y % step_ == 0 ? prefilter_.words(y - padding_, block)
                                             : prefilter_.faintWords(y - padding_, block);
    if ((marks[block] & may) != 0) testWords(y, block, marks[block] & may, ahead);
  }
}

void CircleSearch::testBetween() {
  const std::size_t blocks = edge_words_.size();
  for (int y = first_row_; y <= last_row_; ++y) {
    if (y % step_ == 0) continue;
    for (std::size_t block = 0; block < blocks; ++block) {
      std::uint64_t may = marks_[static_cast<std::size_t>(y) * blocks + block] &
                          prefilter_.words(y - padding_, block) &
                          ~prefilter_.faintWords(y - padding_, block);
      for (std::uint64_t rest = may; rest != 0; rest &= rest - 1) {
        const int word = std::countr_zero(rest);
        const int x = word_starts_[block * kBits + static_cast<std::size_t>(word)];
        if (occupied_.isCovered(x, x + kWord - 1, y)) may &= ~(std::uint64_t{1} << word);
      }
      if (may != 0) testWords(y, block, may, 0);
    }
  }
}

void CircleSearch::testWords(int y, std::size_t block, std::uint64_t wanted, std::ptrdiff_t ahead) {
  const bool at_edge = y < padding_ + near_ || y >= height_ - padding_ - near_;
  const std::uint64_t edge = at_edge ? wanted : wanted & edge_words_[block];
  const std::size_t first = static_cast<std::size_t>(y / kBand) * word_starts_.size();
  const int* starts = word_starts_.data() + block * kBits;
  const Neighbours* to = neighbours_.data() + first + block * kBits;
  int found = 0;
  if (edge != 0) {
    for (std::uint64_t rest = edge; rest != 0; rest &= rest - 1) {
      const int x = starts[std::countr_zero(rest)];
      padded_.need({x - near_, y - near_, x + kWord + near_, y + near_});
    }
    found = findDarkPixels(edges_.view.row(y), edges_.view.stride, starts, to, edge, 0,
                           search_levels_, dark_.data());
  }
  if (edge != wanted) {
    found += findDarkPixels(inner_.view.row(y), inner_.view.stride, starts, to, wanted & ~edge,
                            ahead, search_levels_, dark_.data() + found);
  }
  for (int i = 0; i < found; ++i) {
    dark_[static_cast<std::size_t>(i)].number += static_cast<int>(block) * kBits;
  }
  examineWords({dark_.data(), static_cast<std::size_t>(found)}, y);
}

void CircleSearch::examineWords(std::span<const DarkPixelWord> words, int y) {
  const std::size_t band = static_cast<std::size_t>(y / kBand) * word_starts_.size();
  bool went_on = false;  // whether the last run continues into this word
  for (std::size_t i = 0; i < words.size(); ++i) {
    const DarkPixelWord& word = words[i];
    const auto number = static_cast<std::size_t>(word.number);
    Candidate candidate{.y = y, .to = neighbours_[band + number], .sizes = sizes_[band + number]};
    const bool adjoins = i + 1 < words.size() && words[i + 1].number == word.number + 1 &&
                         word_starts_[number + 1] == word_starts_[number] + kWord;
    const std::uint32_t next = adjoins ? words[i + 1].dark : 0;
    std::uint32_t dark = went_on ? word.dark & (word.dark + 1) : word.dark;
    went_on = word.dark >> (kWord - 1) != 0 && next % 2 != 0;
    while (dark != 0) {
      const int begin = std::countr_zero(dark);
      const int end = begin + std::countr_one(dark >> begin);
      const int beyond = end == kWord ? std::countr_one(next) : 0;
      const int middle = begin + (end + beyond - begin - 1) / 2;
      const DarkPixelWord& its = words[i + static_cast<std::size_t>(middle / kWord)];
      candidate.x = word_starts_[number] + middle;
      candidate.white = its.white[middle % kWord];
      candidate.dark = inner_.view.row(y)[candidate.x];
      if (!isOccupied(static_cast<float>(candidate.x), static_cast<float>(y), candidate.dark)) {
        const bool may_be_round = (its.round >> middle % kWord) % 2 != 0;
        if (!may_be_round || !examineRound(candidate)) rest_.push_back(candidate);
      }
      dark = end < kWord ? dark >> end << end : 0;
    }
  }
}

bool CircleSearch::examineRound(Candidate candidate) {
  if (isFaint(candidate, levels_)) return false;
  const Plane& plane = planeAt(candidate.x, candidate.y, reach_);
  if (!isRound(plane, candidate)) {
    moveToMiddle(plane, candidate);
    if (!isRound(plane, candidate)) return false;
  }
  Spot spot;
  const Shape shape = outline_.shapeAround(plane, candidate, spot);
  if (shape != Shape::kRound &&
      (shape != Shape::kOther || !outline_.settle(plane, candidate, spot, rejected_spots_))) {
    return false;
  }
  if (!isOccupied(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
  return true;
}

void CircleSearch::examine(const Candidate& candidate) {
  const bool faint = isFaint(candidate, levels_);
  if (faint && !standsOut(planeAt(candidate.x, candidate.y, near_), candidate, levels_.noise))
    return;
  const Plane& plane = planeAt(candidate.x, candidate.y, reach_);
  Spot spot;
  const Shape shape = outline_.shapeAround(plane, candidate, spot);
  if (shape == Shape::kLong) {
    // Otherwise the following rows would find the same object.
    occupied_.markOccupied(static_cast<float>(candidate.x), static_cast<float>(candidate.y),
                           kJunk * candidate.sizes.big, candidate.dark - levels_.black);
    return;
  }
  if (shape == Shape::kThin) return;
  if (faint) {
    if (!outline_.weigh(plane, candidate, reach_, spot)) return;
  } else if (shape == Shape::kOther && !outline_.settle(plane, candidate, spot, rejected_spots_)) {
    return;
  }
  if (!isOccupied(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
}

void CircleSearch::add(Spot spot, const Sizes& sizes) {
  spots_->push_back(spot);
  occupied_.markOccupied(spot.x, spot.y, (spot.can_be_big ? sizes.big : sizes.small) + 1, 0);
}

std::optional<Spot> CircleSearch::centredAs(const Spot& spot, bool big) {
  const float x = spot.x + static_cast<float>(padding_);
  const float y = spot.y + static_cast<float>(padding_);
  const auto word = std::min(static_cast<std::size_t>(spot.x) / kWord, word_starts_.size() - 1);
  const Sizes& sizes = sizes_[static_cast<std::size_t>(y) / kBand * word_starts_.size() + word];
  const Plane& plane = planeAt(static_cast<int>(x), static_cast<int>(y), reach_);
  if (sizes.big <= 0) return std::nullopt;
  std::optional<Spot> out = outline_.centredAt(plane, x, y, big ? sizes.big : sizes.small);
  if (!out) return std::nullopt;
  out->x -= static_cast<float>(padding_);
  out->y -= static_cast<float>(padding_);
  out->can_be_big = big;
  out->can_be_small = !big;
  return out;
}

}  // namespace lab::detector
