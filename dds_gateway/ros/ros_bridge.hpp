/// The bridge from the lab's bus to ROS 2 (docs/ros2.md).
#pragma once

#include <cstdint>
#include <lab/clock_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/experiment/light_messages.hpp"
#include "common/service/service_main.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/ros/foreign_endpoints.hpp"
#include "dds_gateway/ros/gateway_diagnostics.hpp"
#include "dds_gateway/ros/ros_commands.hpp"
#include "dds_gateway/ros/ros_names.hpp"
#include "dds_gateway/ros/ros_publisher.hpp"
#include "dds_gateway/ros/to_ros.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"

namespace lab::gateway {

/// Publishes the lab's messages on DDS as ROS 2 expects them, and accepts ROS 2's commands if the
/// experiment allows them. The topics of a robot are opened with its first message and closed
/// when it has been silent for kForget_us.
class RosBridge {
 public:
  static constexpr std::int64_t kForget_us = 60'000'000;
  static constexpr std::size_t kMostRobots = 500;
  static constexpr std::size_t kMostAnalyzed = 100;  ///< programs with topics of their ANALYSIS

  /// @throws ExperimentError if the topic mapping, the configuration or the certificates are
  /// invalid
  explicit RosBridge(const ServiceContext& context);

 private:
  struct Robot {
    RobotMessages messages;
    RosPublishers::Handle pose;
    RosPublishers::Handle odometry;
    RosPublishers::Handle light;
    std::map<std::string, RosPublishers::Handle> analysis;  ///< by program
    std::optional<tracked_pose_t> tracked;
    std::int64_t tracked_utime = 0;  ///< of its frame
    Motion motion;
    std::int64_t motion_utime = 0;
    std::int64_t heard_utime = 0;  ///< arrival of the last message about it
    std::int8_t origin = 0;
    std::string program;
  };

  void openTopics();
  void subscribe();
  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const light_status_t& status);
  void take(const analysis_t& analysis);
  void take(const clock_t& clock);
  void sendPoses(std::int64_t utime);
  void sendRobots();
  void everySecond();
  void forgetRobots();
  void sendDiagnostics();
  Robot* robot(std::int32_t id);
  bool mayAnalyze(const std::string& part);

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  RosNames names_;
  TopicMapping mapping_;
  dds::Domain domain_;
  RosPublishers publishers_;
  ForeignEndpoints foreign_;
  ExperimentImages images_;

  std::map<std::int32_t, Robot> robots_;
  std::int64_t refused_robots_ = 0;
  std::map<std::string, RosPublishers::Handle> pool_analysis_;
  std::set<std::string> analyzed_;  ///< programs in ANALYSIS, as parts of topic names
  bool analysis_limit_noted_ = false;
  RosPublishers::Handle tf_, poses_, light_field_, robot_list_, diagnostics_, clock_;
  std::vector<ros::TransformStamped> transforms_;
  std::vector<ros::Pose> pose_array_;
  std::string arena_;
  LightGrid grid_;
  std::optional<light::Field> shown_;
  AnalysisMessage analysis_;
  std::string robot_text_;  ///< the list that was last published
  GatewayDiagnostics status_;
  std::int64_t malformed_ = 0;  ///< dds::malformedReceived() one second ago
  std::unique_ptr<RosCommands> commands_;
};

}  // namespace lab::gateway
