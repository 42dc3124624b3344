#include "tracker_svc/blobs/blob_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracker_svc/plane_pose.hpp"

namespace lab::detector {

BlobAxes BlobAxes::sharpened(double blur) const {
  constexpr double kLeast = 0.02;  // [px^2]
  BlobAxes axes = *this;
  axes.major = std::max(kLeast, major - blur * blur);
  axes.minor = std::max(kLeast, minor - blur * blur);
  return axes;
}

BlobAxes axesOf(const BlobMoments& moments) {
  BlobAxes axes;
  const double mean = (moments.second[0] + moments.second[2]) / 2;
  const double difference =
      std::hypot((moments.second[0] - moments.second[2]) / 2, moments.second[1]);
  axes.major = mean + difference;
  axes.minor = std::max(0.0, mean - difference);
  // The outline has less noise.
  const double half = (moments.outline[0] - moments.outline[2]) / 2;
  const double cross = moments.outline[1];
  const double square = half * half + cross * cross;
  axes.angle = 0.5 * std::atan2(cross, half);
  const auto& c = moments.outline_covariance;
  constexpr double kNoAxis = 10;  // [rad^2]
  axes.variance = square > 0
                      ? (half * half * c[2] - 2 * half * cross * c[1] + cross * cross * c[0]) /
                            (4 * square * square)
                      : kNoAxis;
  return axes;
}

namespace {

/// The long axis of the outline on the plane: where the lens stretches one direction, it is not the
/// image of the long axis in the picture.
double axisOnPlane(const BlobMoments& moments, double blur, const optics::PlaneScale& s) {
  constexpr double kClipped = 0.36;  // [1] of the variance of a blurred edge, as clipped
  const double spread = kClipped * blur * blur;
  const double uu = moments.outline[0] - spread;
  const double uv = moments.outline[1];
  const double vv = moments.outline[2] - spread;
  const double xx = s.ux * s.ux * uu + 2 * s.ux * s.uy * uv + s.uy * s.uy * vv;
  const double xy = s.ux * s.vx * uu + (s.ux * s.vy + s.uy * s.vx) * uv + s.uy * s.vy * vv;
  const double yy = s.vx * s.vx * uu + 2 * s.vx * s.vy * uv + s.vy * s.vy * vv;
  return 0.5 * std::atan2(2 * xy, xx - yy);
}

}  // namespace

std::optional<Detection> blobPose(const optics::CameraModel& camera, double height,
                                  const BlobMoments& moments, double blur) {
  const BlobAxes axes = axesOf(moments);
  const auto& c = moments.covariance;
  std::optional<Detection> pose =
      partPose(camera, height, moments.centre, axes.angle, {c[0], c[1], 0, c[2], 0, axes.variance});
  if (!pose) return {};
  pose->heading = HeadingKind::kAxis;
  const std::optional<PlanePoint> middle = planePoint(camera, moments.centre, height);
  if (!middle) return {};
  pose->theta = axisOnPlane(moments, blur, middle->per_pixel);
  pose->white = static_cast<float>(moments.ground);
  // The mean over the blob of places on the plane, each with the area that a pixel shows there: by
  // four points with the blob's second moments.
  double sum = 0;
  double x = 0;
  double y = 0;
  const double cosine = std::cos(axes.angle);
  const double sine = std::sin(axes.angle);
  const double along = std::sqrt(2 * axes.major);
  const double across = std::sqrt(2 * axes.minor);
  const std::array<optics::Pixel, 4> offsets{{{along * cosine, along * sine},
                                              {-along * cosine, -along * sine},
                                              {-across * sine, across * cosine},
                                              {across * sine, -across * cosine}}};
  for (const optics::Pixel& offset : offsets) {
    const std::optional<PlanePoint> at =
        planePoint(camera, {moments.centre.x + offset.x, moments.centre.y + offset.y}, height);
    if (!at) return {};
    const double weight = std::abs(determinant(at->per_pixel));
    sum += weight;
    x += weight * at->place.x;
    y += weight * at->place.y;
  }
  pose->x = x / sum;
  pose->y = y / sum;
  const double unit = std::sqrt(sum / 4);
  const BlobAxes sharp = axes.sharpened(blur);
  pose->length = static_cast<float>(4 * std::sqrt(sharp.major) * unit);
  pose->width = static_cast<float>(4 * std::sqrt(sharp.minor) * unit);
  return pose;
}

std::vector<std::vector<std::size_t>> groupsOf(const std::vector<std::vector<int>>& neighbours) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<bool> seen(neighbours.size(), false);
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (seen[i]) continue;
    seen[i] = true;
    std::vector<std::size_t> group{i};
    for (std::size_t k = 0; k < group.size(); ++k) {
      for (const int other : neighbours[group[k]]) {
        const auto node = static_cast<std::size_t>(other);
        if (seen[node]) continue;
        seen[node] = true;
        group.push_back(node);
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace lab::detector
