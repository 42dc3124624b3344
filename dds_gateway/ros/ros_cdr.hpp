/// Encodes ROS 2's messages without DDS, for files. On the wire Cyclone DDS does it.
#pragma once

#include <cstdint>
#include <vector>

#include "common/schema/cdr_writer.hpp"
#include "dds_gateway/ros/ros_type.hpp"

namespace lab::ros {

/// Encodes one message after the other in the same memory.
class RosCdr {
 public:
  /// @return its bytes, valid until the next call
  template <class Message>
  const std::vector<std::uint8_t>& encode(const Message& message) {
    cdr_.begin();
    put(message);
    return cdr_.encoding();
  }

 private:
  void put(double value) { cdr_.number(value); }
  void put(float value) { cdr_.number(value); }
  void put(std::int32_t value) { cdr_.number(value); }
  void put(std::int8_t value) { cdr_.number(value); }
  void put(std::uint8_t value) { cdr_.number(value); }
  void put(bool value) { cdr_.boolean(value); }

  template <class Sequence>
  void putSequence(const Sequence& sequence) {
    cdr_.length(sequence._length);
    for (std::uint32_t i = 0; i < sequence._length; ++i) put(sequence._buffer[i]);
  }

  void put(const Time& time) {
    cdr_.number(time.sec);
    cdr_.number(time.nanosec);
  }
  void put(const Header& header) {
    put(header.stamp);
    cdr_.text(header.frame_id);
  }
  void put(const String& message) { cdr_.text(message.data); }
  void put(const Point& point) {
    for (const double value : {point.x, point.y, point.z}) cdr_.number(value);
  }
  void put(const Vector3& vector) {
    for (const double value : {vector.x, vector.y, vector.z}) cdr_.number(value);
  }
  void put(const Quaternion& rotation) {
    for (const double value : {rotation.x, rotation.y, rotation.z, rotation.w}) cdr_.number(value);
  }
  void put(const Pose& pose) {
    put(pose.position);
    put(pose.orientation);
  }
  void put(const PoseStamped& message) {
    put(message.header);
    put(message.pose);
  }
  void put(const PoseArray& message) {
    put(message.header);
    putSequence(message.poses);
  }
  void put(const TransformStamped& message) {
    put(message.header);
    cdr_.text(message.child_frame_id);
    put(message.transform.translation);
    put(message.transform.rotation);
  }
  void put(const TFMessage& message) { putSequence(message.transforms); }
  void put(const OccupancyGrid& message) {
    put(message.header);
    put(message.info.map_load_time);
    cdr_.number(message.info.resolution);
    cdr_.number(message.info.width);
    cdr_.number(message.info.height);
    put(message.info.origin);
    putSequence(message.data);
  }
  void put(const Illuminance& message) {
    put(message.header);
    cdr_.number(message.illuminance);
    cdr_.number(message.variance);
  }
  void put(const Curve& curve) {
    cdr_.text(curve.name);
    cdr_.text(curve.unit);
    putSequence(curve.lag);
    putSequence(curve.value);
    putSequence(curve.sigma);
    putSequence(curve.exact);
    putSequence(curve.paper);
    putSequence(curve.windows);
    putSequence(curve.biased);
  }
  void put(const Estimate& estimate) {
    cdr_.text(estimate.name);
    cdr_.text(estimate.unit);
    for (const double value :
         {estimate.value, estimate.sigma, estimate.low, estimate.high, estimate.theory}) {
      cdr_.number(value);
    }
    cdr_.text(estimate.note);
  }
  void put(const Analysis& message) {
    put(message.header);
    cdr_.number(message.robot_id);
    cdr_.text(message.program_name);
    cdr_.number(message.program.hash);
    cdr_.text(message.program.text);
    cdr_.number(message.observed);
    cdr_.number(message.segments);
    cdr_.number(message.reversals);
    cdr_.number(message.contact_share);
    cdr_.number(message.verdict);
    cdr_.number(message.max_z);
    putSequence(message.curves);
    putSequence(message.estimates);
  }

  schema::CdrWriter cdr_;
};

}  // namespace lab::ros
