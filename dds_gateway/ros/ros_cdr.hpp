/// Encodes ROS 2's messages without DDS, for files. On the wire Cyclone DDS does it.
#pragma once

#include <cstdint>

#include "common/schema/cdr_writer.hpp"
#include "dds_gateway/ros/ros_type.hpp"

namespace lab::ros {

using schema::CdrWriter;

inline void put(CdrWriter& cdr, double value) { cdr.number(value); }
inline void put(CdrWriter& cdr, float value) { cdr.number(value); }
inline void put(CdrWriter& cdr, std::int32_t value) { cdr.number(value); }
inline void put(CdrWriter& cdr, std::int8_t value) { cdr.number(value); }
inline void put(CdrWriter& cdr, std::uint8_t value) { cdr.number(value); }
inline void put(CdrWriter& cdr, bool value) { cdr.boolean(value); }

template <class Sequence>
void putSequence(CdrWriter& cdr, const Sequence& sequence) {
  cdr.length(sequence._length);
  for (std::uint32_t i = 0; i < sequence._length; ++i) put(cdr, sequence._buffer[i]);
}

inline void put(CdrWriter& cdr, const Time& time) {
  cdr.number(time.sec);
  cdr.number(time.nanosec);
}
inline void put(CdrWriter& cdr, const Header& header) {
  put(cdr, header.stamp);
  cdr.text(header.frame_id);
}
inline void put(CdrWriter& cdr, const String& message) { cdr.text(message.data); }
inline void put(CdrWriter& cdr, const Point& point) {
  for (const double value : {point.x, point.y, point.z}) cdr.number(value);
}
inline void put(CdrWriter& cdr, const Vector3& vector) {
  for (const double value : {vector.x, vector.y, vector.z}) cdr.number(value);
}
inline void put(CdrWriter& cdr, const Quaternion& rotation) {
  for (const double value : {rotation.x, rotation.y, rotation.z, rotation.w}) cdr.number(value);
}
inline void put(CdrWriter& cdr, const Pose& pose) {
  put(cdr, pose.position);
  put(cdr, pose.orientation);
}
inline void put(CdrWriter& cdr, const PoseStamped& message) {
  put(cdr, message.header);
  put(cdr, message.pose);
}
inline void put(CdrWriter& cdr, const PoseArray& message) {
  put(cdr, message.header);
  putSequence(cdr, message.poses);
}
inline void put(CdrWriter& cdr, const TransformStamped& message) {
  put(cdr, message.header);
  cdr.text(message.child_frame_id);
  put(cdr, message.transform.translation);
  put(cdr, message.transform.rotation);
}
inline void put(CdrWriter& cdr, const TFMessage& message) { putSequence(cdr, message.transforms); }
inline void put(CdrWriter& cdr, const OccupancyGrid& message) {
  put(cdr, message.header);
  put(cdr, message.info.map_load_time);
  cdr.number(message.info.resolution);
  cdr.number(message.info.width);
  cdr.number(message.info.height);
  put(cdr, message.info.origin);
  putSequence(cdr, message.data);
}
inline void put(CdrWriter& cdr, const Illuminance& message) {
  put(cdr, message.header);
  cdr.number(message.illuminance);
  cdr.number(message.variance);
}
inline void put(CdrWriter& cdr, const Curve& curve) {
  cdr.text(curve.name);
  cdr.text(curve.unit);
  putSequence(cdr, curve.lag);
  putSequence(cdr, curve.value);
  putSequence(cdr, curve.sigma);
  putSequence(cdr, curve.exact);
  putSequence(cdr, curve.paper);
  putSequence(cdr, curve.windows);
  putSequence(cdr, curve.biased);
}
inline void put(CdrWriter& cdr, const Estimate& estimate) {
  cdr.text(estimate.name);
  cdr.text(estimate.unit);
  for (const double value :
       {estimate.value, estimate.sigma, estimate.low, estimate.high, estimate.theory}) {
    cdr.number(value);
  }
  cdr.text(estimate.note);
}
inline void put(CdrWriter& cdr, const Analysis& message) {
  put(cdr, message.header);
  cdr.number(message.robot_id);
  cdr.text(message.program_name);
  cdr.number(message.program.hash);
  cdr.text(message.program.text);
  cdr.number(message.observed);
  cdr.number(message.segments);
  cdr.number(message.reversals);
  cdr.number(message.contact_share);
  cdr.number(message.verdict);
  cdr.number(message.max_z);
  putSequence(cdr, message.curves);
  putSequence(cdr, message.estimates);
}

}  // namespace lab::ros
