#include "tracker_svc/fusion/pose_fusion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/angle.hpp"

namespace lab::tracker {
namespace {

Eigen::Matrix3d matrixOf(const std::array<double, 6>& c) {
  Eigen::Matrix3d matrix;
  matrix << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return matrix;
}

Eigen::Vector3d difference(const detector::Detection& from, const detector::Detection& to) {
  return {to.x - from.x, to.y - from.y, wrapAngle(to.theta - from.theta)};
}

bool isDegraded(const detector::Detection& pose) { return (pose.used & detector::kUsedRim) != 0; }

bool agrees(const detector::Detection& a, const detector::Detection& b,
            const FusionSettings& settings) {
  Eigen::Matrix3d spread = matrixOf(a.covariance) + matrixOf(b.covariance);
  spread(0, 0) += settings.calibration_error * settings.calibration_error;
  spread(1, 1) += settings.calibration_error * settings.calibration_error;
  spread(2, 2) += settings.heading_error * settings.heading_error;
  const Eigen::Vector3d apart = difference(a, b);
  return apart.dot(spread.ldlt().solve(apart)) <= settings.gate;
}

/// The robot nearest to the sighting that its camera has not seen yet; null: none is near enough.
FusedPose* robotOf(const Sighting& sighting, std::span<const Sighting> sightings,
                   std::vector<FusedPose>& robots, double reach) {
  FusedPose* nearest = nullptr;
  for (FusedPose& robot : robots) {
    const double distance =
        std::hypot(robot.pose.x - sighting.pose.x, robot.pose.y - sighting.pose.y);
    const auto same_camera = [&](std::size_t k) { return sightings[k].camera == sighting.camera; };
    if (distance >= reach || std::ranges::any_of(robot.sightings, same_camera)) continue;
    reach = distance;
    nearest = &robot;
  }
  return nearest;
}

}  // namespace

detector::Detection fusePoses(std::span<const detector::Detection> poses) {
  detector::Detection fused = poses.front();
  if (poses.size() == 1) return fused;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  for (const detector::Detection& pose : poses) {
    const Eigen::Matrix3d inverse = matrixOf(pose.covariance).inverse();
    information += inverse;
    weighted += inverse * difference(fused, pose);
  }
  const Eigen::Matrix3d c = information.inverse();
  const Eigen::Vector3d shift = c * weighted;
  fused.x += shift(0);
  fused.y += shift(1);
  fused.theta = wrapAngle(fused.theta + shift(2));
  fused.covariance = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  return fused;
}

std::vector<FusedPose> fuseSightings(std::span<const Sighting> sightings,
                                     const FusionSettings& settings) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (sightings[i].pose.quality > 0) order.push_back(i);
  }
  // The best sightings first: full poses, then by the sum of their variances.
  std::ranges::stable_sort(order, [&](std::size_t i, std::size_t k) {
    const detector::Detection& a = sightings[i].pose;
    const detector::Detection& b = sightings[k].pose;
    if (isDegraded(a) != isDegraded(b)) return isDegraded(b);
    return a.covariance[0] + a.covariance[3] < b.covariance[0] + b.covariance[3];
  });
  std::vector<FusedPose> robots;
  for (const std::size_t i : order) {
    FusedPose* robot = robotOf(sightings[i], sightings, robots, settings.same);
    if (robot == nullptr) robot = &robots.emplace_back(FusedPose{sightings[i].pose, {}, 0});
    robot->sightings.push_back(i);
  }
  for (FusedPose& robot : robots) {
    const detector::Detection& best = sightings[robot.sightings.front()].pose;
    std::vector<detector::Detection> used{best};
    for (const std::size_t i : std::span(robot.sightings).subspan(1)) {
      const detector::Detection& pose = sightings[i].pose;
      const bool fits = isDegraded(pose) == isDegraded(best) && agrees(best, pose, settings);
      if (fits) used.push_back(pose);
    }
    robot.rejected = robot.sightings.size() - used.size();
    robot.pose = fusePoses(used);
  }
  std::ranges::sort(robots, {}, [](const FusedPose& robot) { return robot.sightings.front(); });
  return robots;
}

}  // namespace lab::tracker
