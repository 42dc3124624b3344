/// Drives one robot through a calibration pattern in view of the tracker.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "robot_bridge/calibration/drive_pattern.hpp"
#include "robot_bridge/calibration/motors.hpp"
#include "robot_bridge/calibration/speed_check.hpp"

namespace lab::runner {

/// Latest pose of a robot from the tracker.
struct SeenRobot {
  std::int64_t utime = 0;
  calibration::Place place;
};

using SeenRobots = std::map<std::int32_t, SeenRobot>;

/// Commands to the robot; all other robots stand still.
struct DriveActions {
  std::function<void(double left, double right)> drive;  ///< [m/s]
  std::function<void()> stand;                           ///< stops the robot
  std::function<bool()> obeyed;  ///< whether the robot has echoed the latest command
};

/// Turns the robot on the spot to a heading with room for the pattern; if there is none, first
/// drives it away from walls and robots. Then drives the pattern step by step and records the
/// poses. The time of a step begins when the robot echoes the command.
///
/// The owner calls see() and hear() with the messages, and tick() about 50 times per second, until
/// isOver().
class PatternDriver {
 public:
  /// @param believed calibration that the robot uses; determines the duty cycles
  /// @param scene latest poses of all robots, updated by the owner
  PatternDriver(const Experiment& experiment, std::int32_t robot,
                const calibration::Motors& believed, calibration::Pattern pattern,
                const SeenRobots& scene, DriveActions actions);

  void see(const tracked_frame_t& frame);
  void hear(const robot_state_t& state);
  void tick(std::int64_t now);

  [[nodiscard]] bool isOver() const { return phase_ == Phase::kOver; }

  /// Why the pattern was not completed; empty if it was.
  [[nodiscard]] const std::string& failure() const { return failure_; }

  /// The steps driven, with duty cycles and poses.
  [[nodiscard]] std::vector<calibration::CheckedSegment> segments() const;

 private:
  enum class Phase { kPlan, kTurn, kRest, kLeave, kAwaitEcho, kHold, kLastFrames, kOver };

  struct Driven {
    calibration::PatternStep step;
    std::int64_t from = 0;  ///< utime of the first pose that is used
    std::int64_t to = 0;
  };

  void plan();
  void turn();
  void rest();
  void leave();
  void turnTo(double heading);
  void drive(double left_share, double right_share);
  [[nodiscard]] double shareFor(bool moves) const;
  void awaitEcho();
  void hold();
  void enter(Phase phase);
  void beginStep();
  void fail(const std::string& why);
  [[nodiscard]] std::int64_t inPhase() const { return now_ - entered_; }
  [[nodiscard]] const SeenRobot* recentPose() const;
  [[nodiscard]] calibration::Surroundings surroundings() const;
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::string noRoomText() const;

  const Experiment& experiment_;
  std::int32_t robot_;
  calibration::Motors believed_;
  calibration::Pattern pattern_;
  const SeenRobots& seen_robots_;
  DriveActions actions_;

  Phase phase_ = Phase::kPlan;
  std::int64_t now_ = 0;
  std::int64_t entered_ = 0;
  double target_ = 0;        ///< [rad] heading with room
  double escape_ = 0;        ///< [m] distance to drive before the pattern
  calibration::Place from_;  ///< pose at the beginning of the turn or the escape
  double share_ = 0;         ///< part of the full speed in use
  double turn_sign_ = 1;
  int turns_ = 0;
  std::size_t next_step_ = 0;
  std::vector<Driven> driven_;
  std::vector<std::pair<std::int64_t, calibration::TrackPoint>> track_;
  std::string failure_;
};

}  // namespace lab::runner
