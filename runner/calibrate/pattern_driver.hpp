/// One robot driven by hand through a pattern, in front of the tracker.
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

/// Where the tracker saw a robot last.
struct SeenRobot {
  std::int64_t utime = 0;
  calibration::Place place;
};

using SeenRobots = std::map<std::int32_t, SeenRobot>;

/// How a driver moves its robot while all others stand.
struct DriveActions {
  std::function<void(double left, double right)> drive;  ///< [m/s]
  std::function<void()> stand;
  std::function<bool()> obeyed;  ///< whether the robot has echoed the last of these
};

/// Turns the robot on the spot until the pattern has room, and if that is not enough lets it drive
/// a little away from walls and robots first; drives the pattern step by step, each step's time
/// counting from the robot's echo, and keeps what the tracker saw.
///
/// The owner calls see(), hear() and, some 50 times a second, tick(), until isOver().
class PatternDriver {
 public:
  /// @param believed what the robot takes its motors for: gives the duties
  /// @param scene kept up to date by the owner
  PatternDriver(const Experiment& experiment, std::int32_t robot,
                const calibration::Motors& believed, calibration::Pattern pattern,
                const SeenRobots& scene, DriveActions reins);

  void see(const tracked_frame_t& frame);
  void hear(const robot_state_t& state);
  void tick(std::int64_t now);

  [[nodiscard]] bool isOver() const { return phase_ == Phase::kOver; }

  /// Why the pattern was not driven to its end; empty when it was.
  [[nodiscard]] const std::string& failure() const { return failure_; }

  /// What was driven and seen.
  [[nodiscard]] std::vector<calibration::CheckedSegment> segments() const;

 private:
  enum class Phase { kLook, kTurn, kRest, kLeave, kOrder, kHold, kLastFrames, kOver };

  struct Driven {
    calibration::PatternStep step;
    std::int64_t from = 0;  ///< utime of the first pose that counts
    std::int64_t to = 0;
  };

  void look();
  void turn();
  void rest();
  void leave();
  void turnTo(double heading);
  void drive(double left_share, double right_share);
  [[nodiscard]] double shareFor(bool moves) const;
  void order();
  void hold();
  void enter(Phase phase);
  void beginStep();
  void fail(const std::string& why);
  [[nodiscard]] std::int64_t inPhase() const { return now_ - entered_; }
  [[nodiscard]] const SeenRobot* fresh() const;
  [[nodiscard]] calibration::Surroundings surroundings() const;
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::string noRoom() const;

  const Experiment& experiment_;
  std::int32_t robot_;
  calibration::Motors believed_;
  calibration::Pattern pattern_;
  const SeenRobots& seen_robots_;
  DriveActions actions_;

  Phase phase_ = Phase::kLook;
  std::int64_t now_ = 0;
  std::int64_t entered_ = 0;
  double target_ = 0;        ///< [rad] heading with room
  double way_out_ = 0;       ///< [m] to drive first, 0: none
  calibration::Place from_;  ///< where the turn or the way out began
  double share_ = 0;         ///< of full speed, meanwhile
  double turn_sign_ = 1;
  int turns_ = 0;
  std::size_t next_step_ = 0;
  std::vector<Driven> driven_;
  std::vector<std::pair<std::int64_t, calibration::TrackPoint>> track_;
  std::string failure_;
};

}  // namespace lab::runner
