/// Converts the lab's messages to ROS 2's (REP-103: SI, x forward, z up, quaternions; REP-105:
/// frames).
///
/// A ROS 2 message is a C struct here. It points at strings and arrays of the object that made it
/// and is valid until that object makes the next one.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "light/field/field.hpp"

namespace lab::gateway {

[[nodiscard]] ros::Time stampOf(std::int64_t utime);

/// @param text valid UTF-8 without NUL; must live as long as the message
[[nodiscard]] char* cText(const std::string& text);

/// The same for a received text: first replaces invalid UTF-8, because Fast DDS ends a process that
/// reads such a string.
[[nodiscard]] char* sanitizedText(std::string& text);

/// The rotation by theta [rad] about z; w >= 0 for theta in [-pi, pi].
[[nodiscard]] ros::Quaternion yaw(double theta);

/// The pose in the plane z = 0.
[[nodiscard]] ros::Pose toPose(const tracked_pose_t& pose);

/// Writes x, y and yaw of the lab's upper triangle into ROS 2's row-major 6 x 6 matrix over (x, y,
/// z, roll, pitch, yaw). z, roll and pitch of a robot on the floor are known exactly: 0.
void setCovariance(const tracked_pose_t& pose, double (&covariance)[36]);

/// Velocity of a robot in its own frame.
struct Motion {
  double forward = 0;  ///< [m/s]
  double turn = 0;     ///< [rad/s] counter-clockwise
};
[[nodiscard]] Motion motionOf(double wheel_left, double wheel_right, double wheel_base);

/// Variance of a twist without reported wheel speeds [(m/s)^2, (rad/s)^2].
inline constexpr double kUnknownVariance = 1e6;

/// The messages of one robot.
class RobotMessages {
 public:
  /// @param arena,robot names of the frames
  RobotMessages(std::string arena, std::string robot)
      : arena_(std::move(arena)), robot_(std::move(robot)) {}

  [[nodiscard]] ros::PoseStamped pose(std::int64_t utime, const tracked_pose_t& pose) const;
  /// @param motion from the wheel speeds, null: not known
  [[nodiscard]] ros::Odometry odometry(std::int64_t utime, const tracked_pose_t& pose,
                                       const Motion* motion) const;
  [[nodiscard]] ros::TransformStamped transform(std::int64_t utime,
                                                const tracked_pose_t& pose) const;
  /// The reading of the sensor that selects programs, 0 dark .. 1 projector white, not in lux.
  /// Variance 0: not known.
  [[nodiscard]] ros::Illuminance light(const robot_state_t& state, LightSensor sensor) const;

 private:
  std::string arena_;
  std::string robot_;
};

/// The light field as a map: 0 dark .. 100 projector white, row 0 at the smallest y.
class LightGrid {
 public:
  /// @param width,height of the arena [m]. Cells are squares of 1 cm, larger in an arena above 1.6
  /// m x 1.2 m, so that the grid is at most 160 x 120.
  LightGrid(double width, double height, std::string frame);

  /// @param since time at which this light was first shown [us since 1970]
  [[nodiscard]] const ros::OccupancyGrid& paint(const light::CompiledField& field,
                                                std::int64_t utime, std::int64_t since);

 private:
  std::string frame_;
  std::vector<std::int8_t> cells_;
  std::vector<double> row_;
  ros::OccupancyGrid message_{};
};

/// ANALYSIS as active_lab_msgs/Analysis.
class AnalysisMessage {
 public:
  explicit AnalysisMessage(std::string frame) : frame_(std::move(frame)) {}
  /// @param program_text of the experiment's program; empty if it has none
  [[nodiscard]] const ros::Analysis& make(const analysis_t& analysis,
                                          const std::string& program_text);

 private:
  std::string frame_;
  analysis_t source_;
  std::string text_;
  std::vector<ros::Curve> curves_;
  std::vector<std::vector<std::uint8_t>> biased_;
  std::vector<ros::Estimate> estimates_;
  ros::Analysis message_{};
};

/// Builds a diagnostic_msgs/DiagnosticArray.
class Diagnostics {
 public:
  enum Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };
  struct Status {
    Level level = kOk;
    std::string name;
    std::string message;
    std::string hardware;
    std::vector<std::pair<std::string, std::string>> values;
  };

  void add(Status status) { entries_.push_back(std::move(status)); }
  [[nodiscard]] const ros::DiagnosticArray& make(std::int64_t utime);

 private:
  std::vector<Status> entries_;
  std::vector<std::vector<ros::KeyValue>> values_;
  std::vector<ros::DiagnosticStatus> statuses_;
  ros::DiagnosticArray message_{};
};

}  // namespace lab::gateway
