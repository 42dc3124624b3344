/// ROS 2's messages on DDS: their names, their type hashes, ROS 2's QoS profiles.
#pragma once

#include <dds/dds.h>

#include <string>
#include <string_view>

#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/messages.h"

namespace lab::ros {

// Strings are NUL-terminated UTF-8 and never NULL ("" for none): some readers abort on others. An
// outgoing sequence points at our memory (_buffer, _length, _maximum; _release = false).
using Time = builtin_interfaces_msg_dds__Time_;
using Duration = builtin_interfaces_msg_dds__Duration_;
using Header = std_msgs_msg_dds__Header_;
using String = std_msgs_msg_dds__String_;
using Float64 = std_msgs_msg_dds__Float64_;
using Point = geometry_msgs_msg_dds__Point_;
using Vector3 = geometry_msgs_msg_dds__Vector3_;
using Quaternion = geometry_msgs_msg_dds__Quaternion_;
using Pose = geometry_msgs_msg_dds__Pose_;
using PoseWithCovariance = geometry_msgs_msg_dds__PoseWithCovariance_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using PoseArray = geometry_msgs_msg_dds__PoseArray_;
using Twist = geometry_msgs_msg_dds__Twist_;
using TwistWithCovariance = geometry_msgs_msg_dds__TwistWithCovariance_;
using TwistStamped = geometry_msgs_msg_dds__TwistStamped_;
using Transform = geometry_msgs_msg_dds__Transform_;
using TransformStamped = geometry_msgs_msg_dds__TransformStamped_;
using TFMessage = tf2_msgs_msg_dds__TFMessage_;
using Odometry = nav_msgs_msg_dds__Odometry_;
using MapMetaData = nav_msgs_msg_dds__MapMetaData_;
using OccupancyGrid = nav_msgs_msg_dds__OccupancyGrid_;
using Illuminance = sensor_msgs_msg_dds__Illuminance_;
using Image = sensor_msgs_msg_dds__Image_;
using KeyValue = diagnostic_msgs_msg_dds__KeyValue_;
using DiagnosticStatus = diagnostic_msgs_msg_dds__DiagnosticStatus_;
using DiagnosticArray = diagnostic_msgs_msg_dds__DiagnosticArray_;
using Clock = rosgraph_msgs_msg_dds__Clock_;
// The lab's own messages (docs/examples/ros2/active_lab_msgs).
using Program = active_lab_msgs_msg_dds__Program_;
using Estimate = active_lab_msgs_msg_dds__Estimate_;
using Curve = active_lab_msgs_msg_dds__Curve_;
using Analysis = active_lab_msgs_msg_dds__Analysis_;
using LightCommand = active_lab_msgs_msg_dds__LightCommand_;
using ProgramCommand = active_lab_msgs_msg_dds__ProgramCommand_;

/// A type of message that is published or subscribed.
struct RosType {
  const dds_topic_descriptor_t* descriptor;  ///< m_typename: "geometry_msgs::msg::dds_::Twist_"
  std::string_view name;                     ///< "geometry_msgs/msg/Twist"
  std::string_view hash;                     ///< "RIHS01_...", of its definition (REP 2016)
};

/// Specialised for String, Float64, PoseStamped, PoseArray, Twist, TwistStamped, TransformStamped,
/// TFMessage, Odometry, OccupancyGrid, Illuminance, Image, DiagnosticArray, Clock, Analysis,
/// LightCommand, ProgramCommand.
template <class Message>
[[nodiscard]] const RosType& rosType();

/// DDS's name of a topic: "/lab/robot1/pose" -> "rt/lab/robot1/pose".
[[nodiscard]] std::string topicName(std::string_view ros_topic);

/// User data of an endpoint: "typehash=RIHS01_...;". ROS 2 from Iron on warns about endpoints
/// without it.
[[nodiscard]] std::string userData(const RosType& type);

/// ROS 2's standard QoS profiles, with the type's hash. A write blocks at most 10 ms.
[[nodiscard]] dds::Qos defaultQos(const RosType& type);  ///< reliable, 10 kept
[[nodiscard]] dds::Qos latchedQos(const RosType& type,
                                  int depth = 1);       ///< late joiners get `depth`
[[nodiscard]] dds::Qos sensorQos(const RosType& type);  ///< best effort, 5 kept
[[nodiscard]] dds::Qos tfQos(const RosType& type);      ///< reliable, 100 kept

}  // namespace lab::ros
