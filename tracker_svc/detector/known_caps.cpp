#include "tracker_svc/detector/known_caps.hpp"

#include <algorithm>
#include <cmath>

namespace lab::detector {
namespace {

constexpr double kClear =
    0.6;  // [big radii] margin, so that the edge of a touching neighbour's circle is still searched
constexpr double kOverlap = 1.7;  // [cap radii] between two axes, at least

}  // namespace

bool KnownCaps::overlaps(const Detection& pose) const {
  const double least = kOverlap * setup_.cap.cap_radius;
  return std::ranges::any_of(caps_, [&](const Detection& other) {
    const double dx = pose.x - other.x;
    const double dy = pose.y - other.y;
    return dx * dx + dy * dy < least * least;
  });
}

bool KnownCaps::leavesNoRoomAt(optics::Place circle) const {
  return std::ranges::any_of(caps_, [&, least = clearance()](const Detection& cap) {
    return std::hypot(circle.x - cap.x, circle.y - cap.y) < least;
  });
}

bool KnownCaps::isLightEven() const {
  return !caps_.empty() && std::ranges::none_of(caps_, [](const Detection& cap) {
    return (cap.used & kUsedEdge) != 0;
  });
}

void KnownCaps::cover(CircleSearch& search, const Detection& cap) const {
  const LocalScale& scale = setup_.scale.near(cap.middle.x, cap.middle.y);
  search.cover(cap.middle.x, cap.middle.y, clearance() * static_cast<double>(scale.mean));
}

double KnownCaps::clearance() const {
  const optics::CapGeometry& cap = setup_.cap;
  const double offset = std::max(std::abs(cap.big_offset), std::abs(cap.small_offset));
  return 2 * cap.robot_radius - offset - kClear * cap.big_radius;
}

}  // namespace lab::detector
