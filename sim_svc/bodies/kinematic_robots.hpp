/// Robots with prescribed motion that simulated robots can collide with: real robots that a camera
/// sees, and recorded ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/robot_state_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "sim_svc/bodies/replay_robot.hpp"
#include "sim_svc/camera/tracker_model.hpp"
#include "sim_svc/camera_painter.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Moves the world's kinematic disks.
class KinematicRobots {
 public:
  /// A real robot is removed if no frame has contained it for this long.
  static constexpr std::int64_t kLost_us = 2'000'000;

  /// @param directory of the experiment file, which recordings are relative to
  /// @param start_utime when the playback starts
  /// @throws std::runtime_error see RecordedLog
  KinematicRobots(World& world, const Experiment& experiment,
                  const std::filesystem::path& directory, std::int64_t start_utime);

  [[nodiscard]] bool anyReal() const { return !real_.empty(); }
  [[nodiscard]] bool anyReplayed() const { return !replayed_.empty(); }

  /// Moves the real robots to their poses in a camera frame.
  void update(const tracked_frame_t& frame, std::int64_t now);

  /// Moves the recorded robots to their present poses, and removes robots that are gone.
  void follow(std::int64_t now);

  /// Add the recorded robots at a time to the outputs of the service.
  void addTracked(std::int64_t exposure_utime, TrackerModel& tracker) const;
  void addStates(std::int64_t utime, std::vector<robot_state_t>& states) const;
  void addPainted(std::int64_t exposure_utime, double exposure,
                  std::vector<PaintedRobot>& robots) const;
  void addTruth(std::int64_t utime, std::vector<true_pose_t>& robots) const;

 private:
  struct Real {
    std::size_t disk = 0;
    std::int64_t pose_utime = 0;
    bool there = false;
  };
  struct Replayed {
    std::size_t disk = 0;
    ReplayRobot robot;
    bool there = false;
  };

  World& world_;
  std::map<std::int32_t, Real> real_;
  std::vector<Replayed> replayed_;
};

}  // namespace lab::sim
