/// Where robots were seen, and where they will be.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lab::projector {

/// One robot in one camera frame, in the arena frame.
struct ObservedRobot {
  std::int32_t id = 0;
  double x = 0;              ///< [m]
  double y = 0;              ///< [m]
  double theta = 0;          ///< [rad]
  double variance = 0;       ///< [m^2] of x and of y
  double turn_variance = 0;  ///< [rad^2] of theta
  double confidence = 1;     ///< [1]
};

/// All robots of one camera frame.
struct ObservedFrame {
  std::int64_t instance = 0;  ///< of the tracker
  std::int64_t number = 0;    ///< of the frame
  std::int64_t utime = 0;     ///< [us since 1970] middle of the exposure
  std::vector<ObservedRobot> robots{};
};

/// A robot's place and heading.
struct RobotPose {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
};

/// The last poses of one robot.
///
/// Speed v along the heading and turning rate are taken as constant over the window and fitted by
/// least squares, each pose weighted by its variance: first the turning rate to the headings, then,
/// along the arc that these headings give, speed and place to the places. Each rate r is then
/// shrunk to r max(0, 1 - var(r) / r^2) (the positive-part rule of James and Stein), so that a
/// robot that stands is not sent about by the noise of its poses, and a fast one loses nothing.
class Track {
 public:
  static constexpr double kWindow = 0.1;      ///< [s] of poses in a fit; three poses at least
  static constexpr double kLongestGap = 0.5;  ///< [s] between poses that belong together
  static constexpr double kFurthest = 0.25;   ///< [s] nothing is predicted for later
  static constexpr double kFastest = 0.5;     ///< [m/s] what moves faster has jumped
  static constexpr double kFastestTurn = 12;  ///< [rad/s]

  /// Takes a pose later than the last one; an earlier one is ignored. A pose that the robot cannot
  /// have come to is believed only when the next one agrees with it: then the track begins there.
  void see(const ObservedRobot& robot, std::int64_t utime);

  /// Whether there is a pose.
  [[nodiscard]] bool seen() const { return !poses_.empty(); }

  /// When the last pose was, [us since 1970]; only where seen().
  [[nodiscard]] std::int64_t lastUtime() const { return poses_.back().utime; }

  /// The last pose as it was seen.
  [[nodiscard]] RobotPose last() const;

  /// The pose before the last one, where both are of one unbroken track.
  [[nodiscard]] bool joined() const { return poses_.size() > 1; }
  [[nodiscard]] RobotPose before() const;
  [[nodiscard]] std::int64_t beforeUtime() const { return poses_[poses_.size() - 2].utime; }

  /// Where the robot is at `utime`; that of one pose alone, and what lies kFurthest after the last
  /// one, is not moved further.
  [[nodiscard]] RobotPose predicted(std::int64_t utime) const;

  [[nodiscard]] double speed() const { return speed_; }  ///< [m/s] forward
  [[nodiscard]] double turn() const { return turn_; }    ///< [rad/s]

 private:
  struct Pose {
    std::int64_t utime;
    RobotPose place;     ///< theta runs on, without jumps of a turn
    double weight;       ///< [1/m^2]
    double turn_weight;  ///< [1/rad^2]
  };

  [[nodiscard]] static bool reaches(const Pose& from, const Pose& to);
  void append(Pose pose);
  void fit();

  std::vector<Pose> poses_;    ///< of the window, oldest first
  std::vector<Pose> strange_;  ///< one at most, out of the robot's reach
  RobotPose fitted_;           ///< at the time of the last pose
  double speed_ = 0;
  double turn_ = 0;
};

/// What is known of all robots.
class RobotTracks {
 public:
  static constexpr double kLeastConfidence = 0.5;  ///< of poses that are used

  void take(const ObservedFrame& frame);

  /// As if no frame had been taken.
  void forgetPoses() { tracks_.clear(); }

  /// The program that a robot says it runs.
  void report(std::int32_t id, const std::string& program, std::int64_t utime);

  /// Null for one that was never seen.
  [[nodiscard]] const Track* track(std::int32_t id) const;

  /// Whether the robot runs this program, by a report not older than `stale` [s] at `utime`.
  [[nodiscard]] bool runs(std::int32_t id, const std::string& program, std::int64_t utime,
                          double stale) const;

 private:
  struct Report {
    std::string program;
    std::int64_t utime = 0;
  };

  std::map<std::int32_t, Track> tracks_;
  std::map<std::int32_t, Report> reports_;
};

}  // namespace lab::projector
