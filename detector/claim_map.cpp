#include "detector/claim_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace lab::detector {
namespace {

constexpr int kDarker = 2;  // [1] than something long: a circle in it after all

}  // namespace

ClaimMap::ClaimMap(int width, int height)
    : columns_(width / kCell + 1),
      rows_(height / kCell + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1),
      covered_(cells_.size(), 0) {}

void ClaimMap::forget() {
  for (const Claim& claim : claims_) {
    for (int j = claim.top; j <= claim.bottom; ++j) {
      for (int i = claim.left; i <= claim.right; ++i) {
        cells_[static_cast<std::size_t>(j * columns_ + i)] = -1;
      }
    }
  }
  claims_.clear();
  std::fill(covered_.begin(), covered_.end(), std::uint8_t{0});
}

void ClaimMap::cover(float x, float y, float radius) {
  // Cells whose middle lies within.
  const float at_x = x / kCell - 0.5F;
  const float at_y = y / kCell - 0.5F;
  const float reach = radius / kCell;
  const int top = std::max(static_cast<int>(std::ceil(at_y - reach)), 0);
  const int bottom = std::min(static_cast<int>(at_y + reach), rows_ - 1);
  for (int j = top; j <= bottom; ++j) {
    const float aside = static_cast<float>(j) - at_y;
    const float half = std::sqrt(std::max(reach * reach - aside * aside, 0.0F));
    const int first = std::clamp(static_cast<int>(std::ceil(at_x - half)), 0, columns_);
    const int last = std::min(static_cast<int>(at_x + half), columns_ - 1);
    if (first > last) continue;
    std::memset(covered_.data() + j * columns_ + first, 1,
                static_cast<std::size_t>(last - first + 1));
  }
}

bool ClaimMap::isCovered(int first, int last, int y) const {
  const auto row = covered_.begin() + y / kCell * columns_;
  return std::all_of(row + first / kCell, row + last / kCell + 1,
                     [](std::uint8_t covered) { return covered != 0; });
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
