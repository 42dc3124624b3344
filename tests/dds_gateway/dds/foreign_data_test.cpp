// Invalid data from other participants on our topics: bytes that are not a message, other types.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/dds_gateway/peers/cdr.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {
namespace {

using ros::Cdr;

/// A pose of frame "lab" at (1, 2, 0.5).
Cdr goodPose() {
  Cdr bytes;
  bytes.i32(3).u32(4).text("lab").f64(1).f64(2).f64(0.5).f64(0).f64(0).f64(0.6).f64(0.8);
  return bytes;
}

struct Bad {
  const char* name;
  Payload payload;
};

std::vector<Bad> badPoses() {
  Payload truncated = goodPose().payload();
  truncated.resize(truncated.size() - 8);
  Payload endless = Cdr().i32(3).u32(4).u32(0xffffffff).f64(1).payload();
  Payload unterminated = Cdr().i32(3).u32(4).u32(2).u8('a').u8('b').payload();
  unterminated.resize(200);
  Payload encoded = goodPose().payload();
  encoded[1] = 0x42;
  Payload swapped = goodPose().payload();
  swapped[1] = 0;  // declares big endian
  Payload noise(300);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::uint8_t>(i * 37 + 11);
  return {{"only a header", {0, 1, 0, 0}},
          {"truncated", truncated},
          {"a string longer than the message", endless},
          {"a string without end", unterminated},
          {"an unknown encoding", encoded},
          {"the other byte order", swapped},
          {"noise", noise},
          {"another type", Cdr().f64(0.1).f64(0.2).payload()}};
}

class ForeignData : public testing::Test {
 protected:
  ForeignData()
      : dut(0, localConfiguration(), "test"),
        peer({LAB_CYCLONE_PEER, "0", kHumble}),
        other({LAB_CYCLONE_PEER, "0", kJazzy}) {}

  Domain dut;
  Peer peer;
  Peer other;
  EventDescriptor waker;
  const ros::RosType& type = ros::rosType<ros::PoseStamped>();
};

// After a sample of an unknown encoding Cyclone 0.10.2 receives nothing more from its writer, and
// it drops the whole packets that contain the sample, which delays other writers of the same
// process. Other processes are not affected. Other invalid samples are dropped one by one.
TEST_F(ForeignData, IsDroppedCountedAndReported) {
  int number = 0;
  for (const Bad& bad : badPoses()) {
    SCOPED_TRACE(bad.name);
    const std::string topic = "rt/pose" + std::to_string(++number);
    Peer sender({LAB_CYCLONE_PEER, "0", kHumble});
    Reader reader(dut, *type.descriptor, topic, ros::defaultQos(type), waker);
    for (const Peer* one : {&sender, &other}) {
      one->say("writer " + topic + " " + type.descriptor->m_typename);
    }
    ASSERT_TRUE(sender.says("matched " + topic + " 1"));
    ASSERT_TRUE(other.says("matched " + topic + " 1"));
    ASSERT_TRUE(eventually([&] { return reader.matching().peers == 2; }));
    const std::int64_t before = malformedReceived();
    sender.say("write " + topic + " " + hexOf(bad.payload));
    EXPECT_TRUE(eventually([&] { return malformedReceived() > before; }));
    other.say("write " + topic + " " + hexOf(goodPose().payload()));
    std::vector<double> xs;
    EXPECT_TRUE(eventually([&] {
      reader.take(10, [&](const void* sample, WriterId /*writer*/) {
        xs.push_back(static_cast<const ros::PoseStamped*>(sample)->pose.position.x);
      });
      return !xs.empty();
    }));
    EXPECT_THAT(xs, testing::ElementsAre(1));
    EXPECT_THAT(takeWarnings(), testing::AnyOf(testing::HasSubstr("deserialization " + topic),
                                               testing::HasSubstr("malformed packet")));
  }
}

// A flood of invalid samples gives one line; each sample is counted.
TEST_F(ForeignData, AFloodGivesOneWarning) {
  Qos qos = ros::defaultQos(type);
  qos.depth = 1000;
  Reader reader(dut, *type.descriptor, "rt/pose", qos, waker);
  peer.say("writer rt/pose " + std::string(type.descriptor->m_typename) + " depth=1000");
  ASSERT_TRUE(peer.says("matched rt/pose 1"));
  ASSERT_TRUE(eventually([&] { return reader.matching().peers == 1; }));
  static_cast<void>(takeWarnings());
  const std::int64_t before = malformedReceived();
  for (int i = 0; i < 300; ++i) peer.say("write rt/pose " + hexOf(Cdr().u8(1).payload()));
  EXPECT_TRUE(eventually([&] { return malformedReceived() >= before + 300; }));
  EXPECT_EQ(malformedReceived(), before + 300);
  const std::string complaints = takeWarnings();
  EXPECT_EQ(std::ranges::count(complaints, '\n'), 0) << complaints;
}

// Endpoints with the same topic name and different types are not matched, in any order.
TEST_F(ForeignData, AnotherTypeOnOurTopicIsNotMatched) {
  peer.say("writer rt/pose other_msgs::msg::dds_::Pose_");
  Reader reader(dut, *type.descriptor, "rt/pose", ros::defaultQos(type), waker);
  const Writer writer(dut, *type.descriptor, "rt/pose", ros::defaultQos(type));
  other.say("writer rt/pose " + std::string(type.descriptor->m_typename));
  ASSERT_TRUE(other.says("matched rt/pose 1"));
  ASSERT_TRUE(eventually([&] { return reader.matching().peers == 1; }));
  peer.say("write rt/pose " + hexOf(goodPose().payload()));
  peer.say("sync written");
  ASSERT_TRUE(peer.says("synced written"));
  EXPECT_THAT(peer.heard(), testing::Not(testing::Contains(testing::StartsWith("matched"))));
  EXPECT_EQ(reader.matching().refused, 0);
  EXPECT_EQ(writer.matching().peers, 0);
}

}  // namespace
}  // namespace lab::dds
