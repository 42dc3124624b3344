/// Tracks of robots and predictions of their poses.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "robot/dynamics/kinematics.hpp"

namespace lab::projector {

/// One robot in one camera frame, in the arena frame.
struct ObservedRobot {
  std::int32_t id = 0;
  double x = 0;              ///< [m]
  double y = 0;              ///< [m]
  double theta = 0;          ///< [rad]
  double variance = 0;       ///< [m^2] variance of x and of y
  double turn_variance = 0;  ///< [rad^2] variance of theta
  double confidence = 1;     ///< [1]
};

/// All robots in one camera frame.
struct ObservedFrame {
  std::int64_t instance = 0;  ///< instance of the tracker
  std::int64_t number = 0;    ///< number of the frame
  std::int64_t utime = 0;     ///< [us since 1970] middle of the exposure
  std::vector<ObservedRobot> robots{};
};

using RobotPose = dynamics::Pose;

/// The last poses of one robot.
///
/// Speed v along the heading and turning rate are assumed constant over the window and fitted by
/// least squares, with poses weighted by their inverse variance: first the turning rate to the
/// headings, then speed and position along the resulting arc to the positions. Each rate r is then
/// shrunk to r max(0, 1 - var(r) / r^2) (positive-part James-Stein estimator), so that noise does
/// not move the prediction of a standing robot, while the rates of a fast robot are nearly
/// unchanged.
class Track {
 public:
  static constexpr double kWindow = 0.1;      ///< [s] of poses in a fit; at least three poses
  static constexpr double kLongestGap = 0.5;  ///< [s] a longer gap starts a new track
  static constexpr double kFurthest = 0.25;   ///< [s] longest prediction
  static constexpr double kFastest = 0.5;     ///< [m/s] faster motion is an outlier
  static constexpr double kFastestTurn = 12;  ///< [rad/s]

  /// Adds a pose; it is ignored if it is not later than the last one. A pose that the robot cannot
  /// have reached is only accepted when the next one agrees with it; then a new track begins there.
  void add(const ObservedRobot& robot, std::int64_t utime);

  /// Whether there is a pose.
  [[nodiscard]] bool hasPose() const { return !poses_.empty(); }

  /// Time of the last pose [us since 1970]; hasPose() must be true.
  [[nodiscard]] std::int64_t lastUtime() const { return poses_.back().utime; }

  /// The last observed pose.
  [[nodiscard]] RobotPose last() const;

  /// The pose before the last one, if joined(): both belong to the same track.
  [[nodiscard]] bool joined() const { return poses_.size() > 1; }
  [[nodiscard]] RobotPose before() const;
  [[nodiscard]] std::int64_t beforeUtime() const { return poses_[poses_.size() - 2].utime; }

  /// The predicted pose at `utime`. With a single pose, or more than kFurthest after the last one,
  /// the prediction does not move.
  [[nodiscard]] RobotPose predicted(std::int64_t utime) const;

  [[nodiscard]] double speed() const { return speed_; }  ///< [m/s] forward
  [[nodiscard]] double turn() const { return turn_; }    ///< [rad/s]

 private:
  struct Pose {
    std::int64_t utime;
    RobotPose place;     ///< theta is unwrapped
    double weight;       ///< [1/m^2]
    double turn_weight;  ///< [1/rad^2]
  };

  [[nodiscard]] static bool reaches(const Pose& from, const Pose& to);
  void append(Pose pose);
  void fit();

  std::vector<Pose> poses_;    ///< in the window, oldest first
  std::vector<Pose> outlier_;  ///< at most one pose that the robot cannot have reached
  RobotPose fitted_;           ///< at the time of the last pose
  double speed_ = 0;
  double turn_ = 0;
};

/// The tracks of the robots of an experiment, and the programs that they report. Others are
/// ignored, so that messages about ever new ids take no memory.
class RobotTracks {
 public:
  static constexpr double kLeastConfidence = 0.5;  ///< poses below are not used

  /// @param robots ids
  explicit RobotTracks(const std::vector<std::int32_t>& robots)
      : known_(robots.begin(), robots.end()) {}

  void add(const ObservedFrame& frame);

  /// Forgets all camera frames.
  void forgetPoses() { tracks_.clear(); }

  /// Stores the program that a robot reports. A name that no program can have is none.
  void report(std::int32_t id, const std::string& program, std::int64_t utime);

  /// Null if there is no pose of the robot.
  [[nodiscard]] const Track* track(std::int32_t id) const;

  /// Whether the robot's last report is of this program and not older than `stale` [s] at `utime`.
  [[nodiscard]] bool runs(std::int32_t id, const std::string& program, std::int64_t utime,
                          double stale) const;

 private:
  struct Report {
    std::string program;
    std::int64_t utime = 0;
  };

  std::set<std::int32_t> known_;
  std::map<std::int32_t, Track> tracks_;
  std::map<std::int32_t, Report> reports_;
};

}  // namespace lab::projector
