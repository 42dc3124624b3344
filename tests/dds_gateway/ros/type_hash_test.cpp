#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "dds_gateway/ros/ros_type.hpp"
#include "tests/dds_gateway/ros/type_description.hpp"
#include "tests/support/text_file.hpp"

namespace lab::ros {
namespace {

namespace fs = std::filesystem;

const Definitions& idl() {
  static const Definitions all =
      fromIdl(support::readFile(fs::path(LAB_ROOT) / "dds_gateway/ros/messages.idl"));
  return all;
}

template <class Message>
class TypeHash : public testing::Test {};

using All = testing::Types<String, Float64, PoseStamped, PoseArray, Twist, TwistStamped,
                           TransformStamped, TFMessage, Odometry, OccupancyGrid, Illuminance, Image,
                           DiagnosticArray, Clock, Analysis, LightCommand, ProgramCommand>;
TYPED_TEST_SUITE(TypeHash, All);

TYPED_TEST(TypeHash, IsThatOfTheDefinitionInOurIdl) {
  const RosType& type = rosType<TypeParam>();
  EXPECT_EQ(type.hash, typeHash(idl(), std::string(type.name)));
}

TYPED_TEST(TypeHash, NamesFitTogether) {
  const RosType& type = rosType<TypeParam>();
  const std::string name(type.name);
  const std::string package = name.substr(0, name.find('/'));
  const std::string message = name.substr(name.rfind('/') + 1);
  EXPECT_EQ(type.descriptor->m_typename, package + "::msg::dds_::" + message + "_");
  EXPECT_EQ(type.descriptor->m_nkeys, 0U);
  EXPECT_EQ(type.descriptor->type_information.sz, 0U);
}

// The hashes that ROS 2 prints for its own messages (ros2 topic info -v).
TEST(TypeHashes, AreThoseOfRos2) {
  const std::map<std::string_view, std::string_view> known = {
      {rosType<String>().hash, "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
      {rosType<Float64>().hash, "705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"},
      {rosType<PoseStamped>().hash,
       "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
      {rosType<PoseArray>().hash,
       "af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0"},
      {rosType<Twist>().hash, "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
      {rosType<TwistStamped>().hash,
       "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
      {rosType<Odometry>().hash,
       "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {rosType<TFMessage>().hash,
       "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {rosType<Illuminance>().hash,
       "b954b25f452fcf81a91c9c2a7e3b3fd85c4c873d452aecb3cfd8fd1da732a22d"},
      {rosType<Image>().hash, "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
      {rosType<DiagnosticArray>().hash,
       "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {rosType<OccupancyGrid>().hash,
       "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
      {rosType<Clock>().hash, "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"}};
  EXPECT_EQ(known.size(), 13U);
  for (const auto& [ours, theirs] : known) EXPECT_EQ(ours, "RIHS01_" + std::string(theirs));
}

// docs/examples/ros2/active_lab_msgs defines the same messages, by name, order and hash.
TEST(TypeHashes, MsgFilesDefineOurMessages) {
  const std::string package = "active_lab_msgs";
  int files = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(LAB_ROOT) / "docs/examples/ros2/active_lab_msgs/msg")) {
    const std::string name = package + "/msg/" + entry.path().stem().string();
    EXPECT_EQ(fromMsg(support::readFile(entry.path()), package), idl().at(name)) << name;
    ++files;
  }
  int structs = 0;
  for (const auto& [name, fields] : idl()) structs += name.starts_with(package) ? 1 : 0;
  EXPECT_EQ(files, structs);
}

TEST(TypeHashes, DependOnEachFieldAndItsType) {
  const std::string name = "nav_msgs/msg/OccupancyGrid";
  const std::string hash = typeHash(idl(), name);
  Definitions changed = idl();
  changed.at(name).back().type = "uint8";
  EXPECT_NE(typeHash(changed, name), hash);
  changed = idl();
  changed.at("builtin_interfaces/msg/Time").front().name = "secs";
  EXPECT_NE(typeHash(changed, name), hash);
}

TEST(RosNames, OnDdsHaveThePrefixOfTopics) {
  EXPECT_EQ(topicName("/lab/robot1/pose"), "rt/lab/robot1/pose");
  EXPECT_EQ(userData(rosType<Clock>()),
            "typehash=RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564;");
}

TEST(RosProfiles, AreThoseOfRos2) {
  const RosType& type = rosType<Clock>();
  for (const dds::Qos& qos :
       {defaultQos(type), latchedQos(type, 3), sensorQos(type), tfQos(type)}) {
    EXPECT_EQ(qos.user_data, userData(type));
    EXPECT_LE(qos.max_blocking_time, 0.01);
  }
  EXPECT_TRUE(defaultQos(type).reliable);
  EXPECT_FALSE(defaultQos(type).latched);
  EXPECT_EQ(defaultQos(type).depth, 10);
  EXPECT_TRUE(latchedQos(type, 3).latched);
  EXPECT_EQ(latchedQos(type, 3).depth, 3);
  EXPECT_FALSE(sensorQos(type).reliable);
  EXPECT_EQ(tfQos(type).depth, 100);
}

}  // namespace
}  // namespace lab::ros
