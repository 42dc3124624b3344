// What is dark in a row, and what of it may be a circle.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracker_svc/circle_search/circle_search.hpp"

namespace lab::detector {
namespace {

constexpr float kJunk = 0.9F;  // [big radii] around it in which nothing else is looked at
constexpr int kStandOut = 3;   // [noise / 4] of means around over means inside

}  // namespace

void CircleSearch::takeWords(std::span<const DarkPixelWord> words, int y) {
  const std::size_t band = static_cast<std::size_t>(y / kBand) * word_starts_.size();
  bool went_on = false;  // the last run, into this word
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
        if (!may_be_round || !takeRound(candidate)) rest_.push_back(candidate);
      }
      dark = end < kWord ? dark >> end << end : 0;
    }
  }
}

bool CircleSearch::takeRound(Candidate candidate) {
  if (isFaint(candidate)) return false;
  const Plane& plane = planeAt(candidate.x, candidate.y, reach_);
  if (!isRound(plane, candidate)) {
    moveToMiddle(plane, candidate);
    if (!isRound(plane, candidate)) return false;
  }
  Spot spot;
  const Shape shape = shapeAround(plane, candidate, spot);
  if (shape != Shape::kRound && (shape != Shape::kOther || !settle(plane, candidate, spot))) {
    return false;
  }
  if (!isOccupied(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
  return true;
}

void CircleSearch::moveToMiddle(const Plane& plane, Candidate& candidate) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const int level = (candidate.dark + candidate.white) / 2;
  const auto far = [&](std::ptrdiff_t step) {
    int rows = 1;
    while (rows <= candidate.to.across && at[rows * step] < level) ++rows;
    return rows;
  };
  candidate.y += (far(plane.view.stride) - far(-plane.view.stride)) / 2;
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
  const bool faint = isFaint(candidate);
  if (faint && !standsOut(planeAt(candidate.x, candidate.y, near_), candidate, noise_)) return;
  const Plane& plane = planeAt(candidate.x, candidate.y, reach_);
  Spot spot;
  const Shape shape = shapeAround(plane, candidate, spot);
  if (shape == Shape::kLong) {
    // The next rows would only say the same again.
    occupied_.claim(static_cast<float>(candidate.x), static_cast<float>(candidate.y),
                    kJunk * candidate.sizes.big, candidate.dark - black_);
    return;
  }
  if (shape == Shape::kThin) return;
  if (faint) {
    if (!weigh(plane, candidate, spot)) return;
  } else if (shape == Shape::kOther && !settle(plane, candidate, spot)) {
    return;
  }
  if (!isOccupied(spot.x, spot.y, candidate.dark)) add(spot, candidate.sizes);
}

void CircleSearch::add(Spot spot, const Sizes& sizes) {
  spots_->push_back(spot);
  occupied_.claim(spot.x, spot.y, (spot.can_be_big ? sizes.big : sizes.small) + 1, 0);
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
  return 2 * (candidate.dark - black_) + noise_ <= candidate.white - black_ && !isFaint(candidate);
}

bool CircleSearch::standsOut(const Plane& plane, const Candidate& candidate, int noise) {
  const std::uint8_t* at = plane.view.row(candidate.y) + candidate.x;
  const std::ptrdiff_t stride = plane.view.stride;
  const std::ptrdiff_t near = candidate.to.near;
  const std::ptrdiff_t across = candidate.to.across;
  const std::ptrdiff_t diagonal = candidate.to.diagonal;
  const int inner = at[0] + at[near] + at[-near] + at[near * stride] + at[-near * stride];
  // Light to one side does not make up for what is as dark as this to the others.
  const int most = candidate.white + noise / 4;
  int outer = 0;
  for (const std::ptrdiff_t to :
       {across, across * stride, diagonal * (stride + 1), diagonal * (stride - 1)}) {
    outer += std::min<int>(at[to], most) + std::min<int>(at[-to], most);
  }
  // The mean of eight less the mean of five, in units of 1/40 DN.
  return 5 * outer - 8 * inner >= 40 * kStandOut * noise / 4;
}

}  // namespace lab::detector
