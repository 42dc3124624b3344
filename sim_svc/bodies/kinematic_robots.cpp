#include "sim_svc/bodies/kinematic_robots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"

namespace lab::sim {
namespace {

/// Of the robot in its log.
std::int32_t recordedId(const RobotSpec& robot) {
  return robot.recorded_id == 0 ? robot.id : robot.recorded_id;
}

}  // namespace

KinematicRobots::KinematicRobots(World& world, const Experiment& experiment,
                                 const std::filesystem::path& directory, std::int64_t start_utime)
    : world_(world) {
  std::map<std::string, std::vector<std::int32_t>> wanted;  // by log
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body == Body::kReplay) wanted[robot.log].push_back(recordedId(robot));
  }
  std::map<std::string, RecordedLog> logs;
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body == Body::kSerial) real_[robot.id].disk = world_.addKinematicDisk();
    if (robot.body != Body::kReplay) continue;
    try {
      auto log = logs.find(robot.log);
      if (log == logs.end()) {
        log = logs.emplace(robot.log, RecordedLog(directory / robot.log, wanted[robot.log])).first;
      }
      ReplayRobot replay(log->second.take(recordedId(robot), robot.from), robot.id, start_utime);
      replayed_.push_back({world_.addKinematicDisk(), std::move(replay)});
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("robot {} is to replay {}", robot.id, error.what()));
    }
  }
}

void KinematicRobots::update(const tracked_frame_t& frame, std::int64_t now) {
  for (const tracked_pose_t& pose : frame.robots) {
    const auto entry = real_.find(pose.robot_id);
    if (entry == real_.end()) continue;
    entry->second.there = true;
    entry->second.pose_utime = now;
    world_.moveKinematicDisk(entry->second.disk, {pose.x, pose.y});
  }
}

void KinematicRobots::follow(std::int64_t now) {
  for (auto& [id, real] : real_) {
    if (!real.there || now - real.pose_utime <= kLost_us) continue;
    real.there = false;
    world_.hideKinematicDisk(real.disk);
  }
  for (Replayed& replayed : replayed_) {
    if (const auto pose = replayed.robot.lastPose(now)) {
      replayed.there = true;
      world_.moveKinematicDisk(replayed.disk, {pose->x, pose->y});
    } else if (replayed.there) {
      replayed.there = false;
      world_.hideKinematicDisk(replayed.disk);
    }
  }
}

void KinematicRobots::addTracked(std::int64_t exposure_utime, TrackerModel& tracker) const {
  for (const Replayed& replayed : replayed_) {
    if (const auto pose = replayed.robot.trackedPose(exposure_utime)) tracker.add(*pose);
  }
}

void KinematicRobots::addStates(std::int64_t utime, std::vector<robot_state_t>& states) const {
  for (const Replayed& replayed : replayed_) {
    if (auto state = replayed.robot.state(utime)) states.push_back(*state);
  }
}

/// While the recorded tracker had lost a robot, it is painted at its last pose.
void KinematicRobots::addPainted(std::int64_t exposure_utime, double exposure,
                                 std::vector<PaintedRobot>& robots) const {
  const std::int64_t half = std::max<std::int64_t>(1, units::microseconds(exposure) / 2);
  for (const Replayed& replayed : replayed_) {
    const auto tracked = replayed.robot.trackedPose(exposure_utime);
    const auto pose = tracked ? tracked : replayed.robot.lastPose(exposure_utime);
    if (!pose) continue;
    PaintedRobot robot{pose->x, pose->y, pose->theta};
    robot.tag = replayed.robot.id();
    const auto before = replayed.robot.trackedPose(exposure_utime - half);
    const auto after = replayed.robot.trackedPose(exposure_utime + half);
    if (before && after) {
      const double time = units::seconds(2 * half);
      robot.vx = (after->x - before->x) / time;
      robot.vy = (after->y - before->y) / time;
      robot.omega = wrapAngle(after->theta - before->theta) / time;
    }
    robots.push_back(robot);
  }
}

void KinematicRobots::addTruth(std::int64_t utime, std::vector<true_pose_t>& robots) const {
  for (const Replayed& replayed : replayed_) {
    const auto pose = replayed.robot.lastPose(utime);
    if (!pose) continue;
    true_pose_t truth{};
    truth.robot_id = pose->robot_id;
    truth.x = pose->x;
    truth.y = pose->y;
    truth.theta = pose->theta;
    const auto state = replayed.robot.state(utime);
    truth.program = state ? state->program.hash : std::int64_t{-1};
    robots.push_back(truth);
  }
}

}  // namespace lab::sim
