#include "tracker_svc/detector/degraded_poses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "common/math/angle.hpp"
#include "tracker_svc/detector/cap_check.hpp"
#include "tracker_svc/detector/cap_pose.hpp"
#include "tracker_svc/detector/rim_fit.hpp"

namespace lab::detector {
namespace {

constexpr double kRough = 0.003;  // [m] error of a spot's centre
constexpr double kApart = 1.7;    // [cap radii] between two axes, at least
constexpr double kScan = 0.05;    // [rad] between tested headings
// of the directions inside the picture in which the rim must be visible
constexpr double kLeastShare = 0.6;
constexpr int kLeastDirections = kRimDirections / 3;
constexpr double kMostSpacingChi2 = 16;  // with one degree of freedom
constexpr double kMostTurned = 0.1;      // [rad] standard deviation
constexpr double kMostMoved = 0.0015;    // [m] standard deviation
constexpr float kBestDegraded = 0.49F;   // quality

double distance(double x, double y, double to_x, double to_y) {
  return std::hypot(x - to_x, y - to_y);
}

}  // namespace

int DegradedPoses::unpairedCircle(const Expected& expected, bool& is_big) {
  const double offset =
      std::max(std::abs(setup_.cap.big_offset), std::abs(setup_.cap.small_offset));
  int lone = -1;
  optics::Place place;
  for (std::size_t i = 0; i < circles_.size(); ++i) {
    const std::optional<optics::Place> rough = setup_.camera.toPlane(
        {static_cast<double>(circles_.spots()[i].x), static_cast<double>(circles_.spots()[i].y)},
        setup_.cap.height);
    if (!rough ||
        distance(rough->x, rough->y, expected.x, expected.y) > expected.reach + offset + kRough) {
      continue;
    }
    const int spot = static_cast<int>(i);
    const bool big =
        circles_.spots()[i].can_be_big && circles_.fit(spot, true).fit.fault == FitFault::kNone;
    const bool small =
        circles_.spots()[i].can_be_small && circles_.fit(spot, false).fit.fault == FitFault::kNone;
    if (!big && !small) continue;
    if (big && small) return -1;  // its identity must be certain
    const FittedCircles::Circle& circle = circles_.of(spot, big);
    const optics::Place& at = circle.place;
    if (lone >= 0) {
      // Circles do not overlap: this is the same circle centred again, or fitted with a light edge
      // that does not exist.
      const bool again = distance(at.x, at.y, place.x, place.y) < setup_.cap.small_radius;
      const bool edge = circles_.of(lone, is_big).fit.edge;
      if (again && (big == is_big || (circle.fit.edge && !edge))) continue;
      // two circles that form no pair: contradictory
      if (!again || circle.fit.edge || !edge) return -1;
    }
    lone = spot;
    place = at;
    is_big = big;
  }
  return lone;
}

Detection DegradedPoses::poseFromOne(const Expected& expected) {
  bool big = false;
  const int spot = unpairedCircle(expected, big);
  if (spot < 0) return {};
  const FittedCircles::Circle& circle = circles_.of(spot, big);
  const double offset = big ? setup_.cap.big_offset : setup_.cap.small_offset;
  // Heading with the highest rim contrast.
  optics::Place middle;
  float rim = 0;
  const int steps = static_cast<int>(std::ceil(std::min(expected.turn, std::numbers::pi) / kScan));
  for (int step = -steps; step <= steps; ++step) {
    const double theta = expected.theta + kScan * step;
    const optics::Place at{circle.place.x - offset * std::cos(theta),
                           circle.place.y - offset * std::sin(theta)};
    if (distance(at.x, at.y, expected.x, expected.y) > expected.reach + kRough) continue;
    const float contrast =
        rimAround(circles_.picture(), setup_.camera, setup_.cap, setup_.imaging, at);
    if (contrast > rim) {
      rim = contrast;
      middle = at;
    }
  }
  if (rim < kLeastRim) return {};
  const RimFit fit = fitRim(circles_.picture(), setup_.camera, setup_.cap, setup_.imaging, middle);
  if (fit.support < kLeastDirections || fit.support < kLeastShare * fit.visible) return {};
  const CapPose pose =
      poseFromRim({circle.place, circle.covariance}, offset, {fit.centre, fit.covariance});
  const auto& c = pose.covariance;
  if (!(pose.spacing_chi2 < kMostSpacingChi2 && c[5] < kMostTurned * kMostTurned &&
        c[0] + c[3] < 2 * kMostMoved * kMostMoved)) {
    return {};
  }
  Detection out;
  out.x = pose.x;
  out.y = pose.y;
  out.theta = pose.theta;
  out.covariance = pose.covariance;
  out.white = circle.fit.white;
  out.ratio = circle.fit.ratio;
  (big ? out.big : out.small) = {circle.fit.x, circle.fit.y};
  out.middle = setup_.camera.project(out.x, out.y, setup_.cap.height);
  out.used = static_cast<std::uint8_t>(kUsedRim | (big ? kUsedBig : kUsedSmall));
  if (circle.fit.edge) out.used |= kUsedEdge;
  out.quality = kBestDegraded * static_cast<float>(fit.support) / static_cast<float>(fit.visible) *
                std::min(1.0F, rim / kUsualRim);
  return out;
}

const std::vector<DegradedPose>& DegradedPoses::find(std::span<const Expected> expected) {
  degraded_.clear();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Expected& cap = expected[i];
    // With a larger reach another cap could be meant.
    if (!(cap.reach <= setup_.cap.cap_radius)) continue;
    const auto at = [&](const Detection& one, double most) {
      return distance(one.x, one.y, cap.x, cap.y) <= most;
    };
    if (std::ranges::any_of(known_.caps(),
                            [&](const Detection& one) { return at(one, cap.reach); })) {
      continue;
    }
    const Detection pose = poseFromOne(cap);
    if (pose.quality <= 0 || !at(pose, cap.reach)) continue;
    const double turned = wrapAngle(pose.theta - cap.theta);
    if (std::abs(turned) > cap.turn) continue;
    const auto overlaps = [&](const Detection& other) {
      return distance(pose.x, pose.y, other.x, other.y) < kApart * setup_.cap.cap_radius;
    };
    if (std::ranges::any_of(known_.caps(), overlaps)) continue;
    if (std::ranges::any_of(degraded_, [&](const DegradedPose& r) { return overlaps(r.pose); }))
      continue;
    degraded_.push_back({i, pose});
  }
  return degraded_;
}

}  // namespace lab::detector
