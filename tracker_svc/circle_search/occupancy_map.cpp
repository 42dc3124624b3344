#include "tracker_svc/circle_search/occupancy_map.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace lab::detector {
namespace {

constexpr int kDarker = 2;  // [1] times darker than the elongated object: may be a circle on it

}  // namespace

OccupancyMap::OccupancyMap(int width, int height)
    : columns_(width / kCell + 1),
      rows_(height / kCell + 1),
      wide_columns_(width / kWide + 1),
      wide_rows_(height / kWide + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1),
      nearby_(static_cast<std::size_t>(wide_columns_) * static_cast<std::size_t>(wide_rows_)) {}

void OccupancyMap::forget() {
  for (const OccupiedRegion& region : occupied_) {
    for (int j = region.top; j <= region.bottom; ++j) {
      for (int i = region.left; i <= region.right; ++i) {
        cells_[static_cast<std::size_t>(j * columns_ + i)] = -1;
      }
    }
  }
  occupied_.clear();
  for (Nearby& nearby : nearby_) nearby.count = 0;
  covers_.clear();
}

void OccupancyMap::cover(float x, float y, float radius) {
  if (covers_.size() >= std::numeric_limits<std::int16_t>::max()) return;
  const auto number = static_cast<std::int16_t>(covers_.size());
  covers_.push_back({x, y, radius * radius});
  const auto cell = [](float at, int cells) {
    return static_cast<int>(std::clamp(at / kWide, 0.0F, static_cast<float>(cells - 1)));
  };
  const int right = cell(x + radius, wide_columns_);
  const int bottom = cell(y + radius, wide_rows_);
  for (int j = cell(y - radius, wide_rows_); j <= bottom; ++j) {
    for (int i = cell(x - radius, wide_columns_); i <= right; ++i) {
      Nearby& nearby = nearby_[static_cast<std::size_t>(j * wide_columns_ + i)];
      if (nearby.count == Nearby::kMost) continue;
      nearby.covers[static_cast<std::size_t>(nearby.count++)] = number;
    }
  }
}

void OccupancyMap::markOccupied(float x, float y, float reach, int dark) {
  if (occupied_.size() >= std::numeric_limits<std::int16_t>::max()) return;
  OccupiedRegion region{.x = x, .y = y, .reach = reach, .dark = dark};
  region.left = std::clamp(static_cast<int>(x - reach) / kCell, 0, columns_ - 1);
  region.right = std::clamp(static_cast<int>(x + reach) / kCell, 0, columns_ - 1);
  region.top = std::clamp(static_cast<int>(y - reach) / kCell, 0, rows_ - 1);
  region.bottom = std::clamp(static_cast<int>(y + reach) / kCell, 0, rows_ - 1);
  const auto number = static_cast<std::int16_t>(occupied_.size());
  occupied_.push_back(region);
  for (int j = region.top; j <= region.bottom; ++j) {
    for (int i = region.left; i <= region.right; ++i) {
      cells_[static_cast<std::size_t>(j * columns_ + i)] = number;
    }
  }
}

bool OccupancyMap::holds(const OccupiedRegion& region, float x, float y, int dark, int noise) {
  const float dx = x - region.x;
  const float dy = y - region.y;
  const bool darker = kDarker * dark + noise < region.dark;
  return !darker && dx * dx + dy * dy < region.reach * region.reach;
}

}  // namespace lab::detector
