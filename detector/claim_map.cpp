#include "detector/claim_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace lab::detector {
namespace {

constexpr int kDarker = 2;  // [1] than something long: a circle in it after all

constexpr int kLanes = 16;
using Cells = std::int16_t __attribute__((vector_size(2 * kLanes)));

/// Sets some cells, sixteen at once: how many there are is another number each time, which costs
/// more than it takes.
/// @param cells to be set, and fifteen more that may be read
void setCells(std::int16_t* cells, int count, std::int16_t to) {
  constexpr Cells kEach = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  for (int at = 0; at < count; at += kLanes) {
    Cells here;
    std::memcpy(&here, cells + at, sizeof here);
    here = kEach + static_cast<std::int16_t>(at) < static_cast<std::int16_t>(count) ? Cells{} + to
                                                                                    : here;
    std::memcpy(cells + at, &here, sizeof here);
  }
}

}  // namespace

ClaimMap::ClaimMap(int width, int height)
    : columns_(width / kCell + 1),
      rows_(height / kCell + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1),
      covered_(cells_.size() + kLanes, -1) {}

void ClaimMap::forget() {
  for (const Claim& claim : claims_) {
    for (int j = claim.top; j <= claim.bottom; ++j) {
      for (int i = claim.left; i <= claim.right; ++i) {
        cells_[static_cast<std::size_t>(j * columns_ + i)] = -1;
      }
    }
  }
  claims_.clear();
  if (!covers_.empty()) std::fill(covered_.begin(), covered_.end(), std::int16_t{-1});
  covers_.clear();
}

void ClaimMap::cover(float x, float y, float radius) {
  if (covers_.size() >= std::numeric_limits<std::int16_t>::max()) return;
  const auto number = static_cast<std::int16_t>(covers_.size());
  covers_.push_back({x, y, radius * radius});
  // Cells whose middle lies within, or half a cell outside: the others have few such pixels.
  const float at_x = x / kCell - 0.5F;
  const float at_y = y / kCell - 0.5F;
  const float reach = radius / kCell + 0.5F;
  const int top = std::max(static_cast<int>(std::ceil(at_y - reach)), 0);
  const int bottom = std::min(static_cast<int>(at_y + reach), rows_ - 1);
  for (int j = top; j <= bottom; ++j) {
    const float aside = static_cast<float>(j) - at_y;
    const float half = std::sqrt(std::max(reach * reach - aside * aside, 0.0F));
    const int first = std::min(static_cast<int>(std::max(at_x - half, -1.0F) + 1), columns_);
    const int last = std::min(static_cast<int>(at_x + half), columns_ - 1);
    setCells(covered_.data() + j * columns_ + first, last - first + 1, number);
  }
}

bool ClaimMap::isCovered(int x, int y) const {
  const int number = covered_[cellAt(x, y)];
  if (number < 0) return false;
  const Cover& cover = covers_[static_cast<std::size_t>(number)];
  const float dx = static_cast<float>(x) - cover.x;
  const float dy = static_cast<float>(y) - cover.y;
  return dx * dx + dy * dy < cover.square;
}

void ClaimMap::claim(float x, float y, float reach, int dark) {
  if (claims_.size() >= std::numeric_limits<std::int16_t>::max()) return;
  Claim claim{.x = x, .y = y, .reach = reach, .dark = dark};
  claim.left = std::clamp(static_cast<int>(x - reach) / kCell, 0, columns_ - 1);
  claim.right = std::clamp(static_cast<int>(x + reach) / kCell, 0, columns_ - 1);
  claim.top = std::clamp(static_cast<int>(y - reach) / kCell, 0, rows_ - 1);
  claim.bottom = std::clamp(static_cast<int>(y + reach) / kCell, 0, rows_ - 1);
  const auto number = static_cast<std::int16_t>(claims_.size());
  claims_.push_back(claim);
  for (int j = claim.top; j <= claim.bottom; ++j) {
    for (int i = claim.left; i <= claim.right; ++i) {
      cells_[static_cast<std::size_t>(j * columns_ + i)] = number;
    }
  }
}

bool ClaimMap::isClaimed(float x, float y, int dark, int noise) const {
  const int number = cells_[cellAt(static_cast<int>(x), static_cast<int>(y))];
  if (number < 0) return false;
  const Claim& claim = claims_[static_cast<std::size_t>(number)];
  const float dx = x - claim.x;
  const float dy = y - claim.y;
  const bool darker = kDarker * dark + noise < claim.dark;
  return !darker && dx * dx + dy * dy < claim.reach * claim.reach;
}

}  // namespace lab::detector
