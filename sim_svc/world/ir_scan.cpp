#include "sim_svc/world/ir_scan.hpp"

#include <algorithm>
#include <cmath>

namespace lab::sim {
namespace {

constexpr double kSin60 = 0.86602540378443864676;
constexpr double kFullScale = 1023;

// Distance to the wall, on one axis, along a direction whose component on this axis is `along`.
double toWall(double from, double along, double size) {
  if (along > 0) {
    return (size - from) / along;
  }
  return along < 0 ? -from / along : HUGE_VAL;
}

}  // namespace

IrScan::IrScan(Vec centre, Vec heading, double radius, double range)
    : centre_(centre), radius_(radius), range_(range) {
  const Vec turned60 = {heading.x / 2 - heading.y * kSin60, heading.y / 2 + heading.x * kSin60};
  axes_ = {heading, turned60, {turned60.x - heading.x, turned60.y - heading.y}};
  distance_.fill(range);
}

void IrScan::addWalls(const Arena& arena) {
  const double reach = radius_ + range_;
  const double nearest = std::min(std::min(centre_.x, arena.width - centre_.x),
                                  std::min(centre_.y, arena.height - centre_.y));
  if (nearest >= reach) {
    return;
  }
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double sign = k < 3 ? 1 : -1;
    const Vec axis = axes_[k % 3];
    const double to_wall = std::min(toWall(centre_.x, sign * axis.x, arena.width),
                                    toWall(centre_.y, sign * axis.y, arena.height));
    addDistance(k, to_wall - radius_);
  }
}

void IrScan::addDisk(Vec to_other) {
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    const double aside = axes_[k].x * to_other.y - axes_[k].y * to_other.x;
    if (std::fabs(aside) >= radius_) {
      continue;
    }
    const double along = axes_[k].x * to_other.x + axes_[k].y * to_other.y;
    const double to_rim = std::fabs(along) - std::sqrt(radius_ * radius_ - aside * aside) - radius_;
    addDistance(along > 0 ? k : k + 3, to_rim);
  }
}

std::array<std::uint16_t, IrScan::kDirections> IrScan::counts() const {
  std::array<std::uint16_t, kDirections> counts{};
  if (!in_range_) {
    return counts;
  }
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double nearness = std::clamp(1 - distance_[k] / range_, 0.0, 1.0);
    counts[k] = roundedCounts(kFullScale * nearness);
  }
  return counts;
}

}  // namespace lab::sim
