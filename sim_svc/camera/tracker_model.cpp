#include "sim_svc/camera/tracker_model.hpp"

#include <algorithm>
#include <lab/robot_state_t.hpp>

#include "common/math/angle.hpp"

namespace lab::sim {

bool TrackerModel::begin(std::int64_t exposure_utime) {
  frame_ = {};
  frame_.utime = exposure_utime;
  frame_.origin = robot_state_t::SIM;
  frame_.frame = number_++;
  frame_.frame_period = 1 / camera_.fps;
  missing_ = nullptr;
  return frames_.uniform() >= camera_.frame_loss;
}

void TrackerModel::beginRecorded(std::int64_t exposure_utime,
                                 const std::vector<std::int32_t>& missing) {
  static_cast<void>(begin(exposure_utime));
  missing_ = &missing;
}

void TrackerModel::observe(std::int32_t robot_id, const dynamics::Pose& truth) {
  Random& random =
      robots_.try_emplace(robot_id, deriveSeed(seed_, robot_id, "tracker noise")).first->second;
  // All numbers are drawn in every frame, so that a drop-out does not change later frames.
  const bool dropped = random.uniform() < camera_.dropout;
  const bool missed =
      missing_ == nullptr ? dropped : std::ranges::binary_search(*missing_, robot_id);
  const double dx = random.normal();
  const double dy = random.normal();
  const double dtheta = random.normal();
  if (missed) return;
  tracked_pose_t pose{};
  pose.robot_id = robot_id;
  pose.x = truth.x + camera_.position_noise * dx;
  pose.y = truth.y + camera_.position_noise * dy;
  pose.theta = wrapAngle(truth.theta + camera_.heading_noise * dtheta);
  pose.covariance[0] = camera_.position_noise * camera_.position_noise;
  pose.covariance[3] = pose.covariance[0];
  pose.covariance[5] = camera_.heading_noise * camera_.heading_noise;
  pose.confidence = 1;
  add(pose);
}

void TrackerModel::add(const tracked_pose_t& pose) {
  frame_.robots.push_back(pose);
  frame_.num_robots = static_cast<std::int32_t>(frame_.robots.size());
}

}  // namespace lab::sim
