#include "tests/support/marker_scenes/marker_score.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <tuple>

#include "tracker_svc/plane_pose.hpp"

namespace lab::cases {
namespace {

constexpr float kGood = 0.5F;

/// The covariance without heading, if it is not known.
double neesOf(const detector::Detection& pose, double x, double y, double theta) {
  const auto& c = pose.covariance;
  if (pose.heading == detector::HeadingKind::kUnknown) {
    Eigen::Matrix2d covariance;
    covariance << c[0], c[1], c[1], c[3];
    const Eigen::Vector2d e(x, y);
    return e.dot(covariance.inverse() * e) / 2;
  }
  Eigen::Matrix3d covariance;
  covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  const Eigen::Vector3d e(x, y, theta);
  return e.dot(covariance.inverse() * e) / 3;
}

}  // namespace

void MarkerScore::add(const MarkerKind& kind, const std::vector<TrueMarker>& truth,
                      const std::vector<detector::Detection>& poses, double time) {
  const optics::CameraModel camera = cameraOf(kind.settings);
  ++pictures;
  seconds += time;
  struct Match {
    double distance;
    std::size_t marker;
    std::size_t pose;
  };
  std::vector<Match> matches;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const double distance = std::hypot(poses[j].x - truth[i].x, poses[j].y - truth[i].y);
      if (distance < 0.7 * truth[i].short_axis) matches.push_back({distance, i, j});
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::tie(a.distance, a.marker, a.pose) < std::tie(b.distance, b.marker, b.pose);
  });
  std::vector<bool> has(truth.size(), false);
  std::vector<bool> used(poses.size(), false);
  for (const Match& match : matches) {
    if (has[match.marker] || used[match.pose]) continue;
    const TrueMarker& marker = truth[match.marker];
    const detector::Detection& pose = poses[match.pose];
    used[match.pose] = true;
    if (pose.quality < kGood && !marker.hidden) continue;
    has[match.marker] = true;
    ++found;
    if (kind.tags && pose.tag != marker.tag) ++ids;
    if (marker.hidden) continue;
    ++measured;
    const double x = pose.x - marker.x;
    const double y = pose.y - marker.y;
    const optics::PlaneScale scale = camera.scaleAt({marker.x, marker.y}, kind.settings.plane);
    position2 += (x * x + y * y) * std::abs(detector::determinant(scale));
    double theta = 0;
    if (pose.heading != detector::HeadingKind::kUnknown) {
      const double turn =
          pose.heading == detector::HeadingKind::kAxis ? std::numbers::pi : 2 * std::numbers::pi;
      theta = std::remainder(pose.theta - marker.theta, turn);
      heading2 += theta * theta;
      ++headings;
      if (pose.covariance[5] > 0) nees_theta += theta * theta / pose.covariance[5];
    }
    if (pose.covariance[0] > 0) {
      nees += neesOf(pose, x, y, theta);
      nees_x += x * x / pose.covariance[0];
    }
  }
  // No decoder reads a tag whose border is cut.
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (kind.tags && truth[i].hidden) {
      found -= has[i] ? 1 : 0;
    } else {
      ++markers;
    }
  }
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (!used[j] && poses[j].quality >= kGood) ++wrong;
  }
}

double MarkerScore::positionRms() const { return std::sqrt(position2 / std::max(measured, 1)); }

double MarkerScore::headingRms_deg() const {
  return std::sqrt(heading2 / std::max(headings, 1)) * 180 / std::numbers::pi;
}

std::string MarkerScore::header() {
  return "markers  recall %  precision %  position px  heading deg  NEES   z2 x  z2 theta  ms";
}

std::string MarkerScore::text() const {
  const double n = std::max(measured, 1);
  return fmt::format(
      "{:7}  {:8.2f}  {:11.2f}  {:11.4f}  {:11.3f}  {:5.2f}  {:5.2f}  {:8.2f}  {:.1f}", markers,
      100 * recall(), 100 * precision(), positionRms(), headingRms_deg(), nees / n, nees_x / n,
      headings > 0 ? nees_theta / headings : 0.0, 1e3 * seconds / std::max(pictures, 1));
}

MarkerScore scoreOf(MarkerKind kind, detector::MarkerDetector& detector, int pictures) {
  MarkerScore score;
  for (int i = 1; i <= pictures; ++i) {
    kind.settings.seed = static_cast<std::uint64_t>(i);
    const std::vector<TrueMarker> truth = placeMarkers(kind, kind.settings.seed);
    const optics::GreyImage picture = paintMarkers(kind.settings, truth);
    score.add(kind, truth, detector.search(picture.view()), 0);
  }
  return score;
}

double fourSigmas(int squares) { return 4 * std::sqrt(2.0 / squares); }

}  // namespace lab::cases
