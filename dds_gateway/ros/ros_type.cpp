#include "dds_gateway/ros/ros_type.hpp"

namespace lab::ros {

// The hashes are recomputed in tests/dds_gateway/ros/type_hash_test.cpp.
template <>
const RosType& rosType<String>() {
  static constexpr RosType kType{
      &std_msgs_msg_dds__String__desc, "std_msgs/msg/String",
      "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"};
  return kType;
}

template <>
const RosType& rosType<Float64>() {
  static constexpr RosType kType{
      &std_msgs_msg_dds__Float64__desc, "std_msgs/msg/Float64",
      "RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"};
  return kType;
}

template <>
const RosType& rosType<PoseStamped>() {
  static constexpr RosType kType{
      &geometry_msgs_msg_dds__PoseStamped__desc, "geometry_msgs/msg/PoseStamped",
      "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"};
  return kType;
}

template <>
const RosType& rosType<PoseArray>() {
  static constexpr RosType kType{
      &geometry_msgs_msg_dds__PoseArray__desc, "geometry_msgs/msg/PoseArray",
      "RIHS01_af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0"};
  return kType;
}

template <>
const RosType& rosType<Twist>() {
  static constexpr RosType kType{
      &geometry_msgs_msg_dds__Twist__desc, "geometry_msgs/msg/Twist",
      "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"};
  return kType;
}

template <>
const RosType& rosType<TwistStamped>() {
  static constexpr RosType kType{
      &geometry_msgs_msg_dds__TwistStamped__desc, "geometry_msgs/msg/TwistStamped",
      "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"};
  return kType;
}

template <>
const RosType& rosType<TransformStamped>() {
  static constexpr RosType kType{
      &geometry_msgs_msg_dds__TransformStamped__desc, "geometry_msgs/msg/TransformStamped",
      "RIHS01_0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"};
  return kType;
}

template <>
const RosType& rosType<TFMessage>() {
  static constexpr RosType kType{
      &tf2_msgs_msg_dds__TFMessage__desc, "tf2_msgs/msg/TFMessage",
      "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
  return kType;
}

template <>
const RosType& rosType<Odometry>() {
  static constexpr RosType kType{
      &nav_msgs_msg_dds__Odometry__desc, "nav_msgs/msg/Odometry",
      "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"};
  return kType;
}

template <>
const RosType& rosType<OccupancyGrid>() {
  static constexpr RosType kType{
      &nav_msgs_msg_dds__OccupancyGrid__desc, "nav_msgs/msg/OccupancyGrid",
      "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"};
  return kType;
}

template <>
const RosType& rosType<Illuminance>() {
  static constexpr RosType kType{
      &sensor_msgs_msg_dds__Illuminance__desc, "sensor_msgs/msg/Illuminance",
      "RIHS01_b954b25f452fcf81a91c9c2a7e3b3fd85c4c873d452aecb3cfd8fd1da732a22d"};
  return kType;
}

template <>
const RosType& rosType<Image>() {
  static constexpr RosType kType{
      &sensor_msgs_msg_dds__Image__desc, "sensor_msgs/msg/Image",
      "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"};
  return kType;
}

template <>
const RosType& rosType<DiagnosticArray>() {
  static constexpr RosType kType{
      &diagnostic_msgs_msg_dds__DiagnosticArray__desc, "diagnostic_msgs/msg/DiagnosticArray",
      "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};
  return kType;
}

template <>
const RosType& rosType<Clock>() {
  static constexpr RosType kType{
      &rosgraph_msgs_msg_dds__Clock__desc, "rosgraph_msgs/msg/Clock",
      "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"};
  return kType;
}

template <>
const RosType& rosType<Analysis>() {
  static constexpr RosType kType{
      &active_lab_msgs_msg_dds__Analysis__desc, "active_lab_msgs/msg/Analysis",
      "RIHS01_35c406b0e70bc9a2ee6d6e4268ee5d56a73e23f99e364f28845ab9cc195a52c6"};
  return kType;
}

template <>
const RosType& rosType<LightCommand>() {
  static constexpr RosType kType{
      &active_lab_msgs_msg_dds__LightCommand__desc, "active_lab_msgs/msg/LightCommand",
      "RIHS01_425c8c53ac074ff66675da0d7b2cf1ebf7db9f1ce437dee11d71561471434f35"};
  return kType;
}

template <>
const RosType& rosType<ProgramCommand>() {
  static constexpr RosType kType{
      &active_lab_msgs_msg_dds__ProgramCommand__desc, "active_lab_msgs/msg/ProgramCommand",
      "RIHS01_b1c58fe3cd5a44a8386ecd05ce0fee46a5196e210eb16c4a8a9642f9daffbb12"};
  return kType;
}

std::string topicName(std::string_view ros_topic) { return "rt" + std::string(ros_topic); }

std::string userData(const RosType& type) { return "typehash=" + std::string(type.hash) + ";"; }

dds::Qos defaultQos(const RosType& type) {
  dds::Qos qos;
  qos.user_data = userData(type);
  return qos;
}

dds::Qos latchedQos(const RosType& type, int depth) {
  dds::Qos qos = defaultQos(type);
  qos.latched = true;
  qos.depth = depth;
  return qos;
}

dds::Qos sensorQos(const RosType& type) {
  dds::Qos qos = defaultQos(type);
  qos.reliable = false;
  qos.depth = 5;
  return qos;
}

dds::Qos tfQos(const RosType& type) {
  dds::Qos qos = defaultQos(type);
  qos.depth = 100;
  return qos;
}

}  // namespace lab::ros
