// The bytes of each message on the wire, both ways, between us and endpoints that pass payloads
// unchanged: of Cyclone as in rmw_cyclonedds, and of Fast DDS if it is installed.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dds_gateway/dds/configuration.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/dds_gateway/peers/peer_loop.hpp"
#include "tests/dds_gateway/ros/golden_messages.hpp"

namespace lab::ros {
namespace {

using dds::hexOf;

class GoldenBytes : public testing::TestWithParam<std::vector<std::string>> {
 protected:
  GoldenBytes() : dut(0, dds::localConfiguration(), "test"), peer(GetParam()) {
    int number = 0;
    for (const GoldenMessage& message : goldenMessages()) {
      names.push_back("rt/m" + std::to_string(++number));
      messages.push_back(message);
    }
  }

  void peerMakes(const std::string& what, std::size_t at, const std::string& topic) const {
    peer.say(what + " " + topic + " " + messages[at].type->descriptor->m_typename +
             " hash=" + std::string(messages[at].type->hash));
  }

  dds::Domain dut;
  dds::Peer peer;
  std::vector<GoldenMessage> messages;
  std::vector<std::string> names;
};

TEST_P(GoldenBytes, AreSent) {
  std::vector<dds::Writer> writers;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const RosType& type = *messages[i].type;
    writers.emplace_back(dut, *type.descriptor, names[i], latchedQos(type));
    peerMakes("reader", i, names[i]);
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    SCOPED_TRACE(messages[i].type->name);
    ASSERT_TRUE(peer.says("matched " + names[i] + " 1"));
    ASSERT_TRUE(dds::eventually([&] { return writers[i].matching().peers == 1; }));
    ASSERT_TRUE(writers[i].write(messages[i].sample));
    ASSERT_TRUE(dds::eventually([&] { return !peer.got(names[i]).empty(); }));
    EXPECT_EQ(peer.got(names[i]), std::vector{hexOf(messages[i].payload)});
  }
}

// A decoded message is written again. It gives the same bytes only if every field was decoded
// correctly, because our own samples give the golden bytes.
TEST_P(GoldenBytes, AreUnderstood) {
  std::vector<dds::Writer> writers;
  std::vector<std::unique_ptr<dds::Reader>> readers;
  const EventDescriptor waker;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const RosType& type = *messages[i].type;
    readers.push_back(
        std::make_unique<dds::Reader>(dut, *type.descriptor, names[i], defaultQos(type), waker));
    writers.emplace_back(dut, *type.descriptor, names[i] + "/back", defaultQos(type));
    peerMakes("writer", i, names[i]);
    peerMakes("reader", i, names[i] + "/back");
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    SCOPED_TRACE(messages[i].type->name);
    ASSERT_TRUE(peer.says("matched " + names[i] + " 1"));
    ASSERT_TRUE(peer.says("matched " + names[i] + "/back 1"));
    ASSERT_TRUE(dds::eventually(
        [&] { return writers[i].matching().peers == 1 && readers[i]->matching().peers == 1; }));
    // Repeated until it arrives: a volatile reader treats a sample as history if the first
    // heartbeat arrives before it.
    int looks = 0;
    ASSERT_TRUE(dds::eventually([&] {
      constexpr int kLooksAWrite = 200;
      if (looks++ % kLooksAWrite == 0) {
        peer.say("write " + names[i] + " " + hexOf(messages[i].payload));
      }
      return readers[i]->take(1, [&](const void* sample, dds::WriterId /*writer*/) {
        EXPECT_TRUE(writers[i].write(sample));
      }) == 1;
    }));
    ASSERT_TRUE(dds::eventually([&] { return !peer.got(names[i] + "/back").empty(); }));
    EXPECT_EQ(peer.got(names[i] + "/back"), std::vector{hexOf(messages[i].payload)});
  }
}

std::string vendor(const testing::TestParamInfo<std::vector<std::string>>& info) {
  return info.param.front() == LAB_CYCLONE_PEER ? "Cyclone" : "FastDds";
}

std::vector<std::vector<std::string>> peers() {
  std::vector<std::vector<std::string>> all = {{LAB_CYCLONE_PEER, "0", dds::kHumble}};
  if (std::string_view(LAB_FASTDDS_PEER) != "") all.push_back({LAB_FASTDDS_PEER, "0"});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Peers, GoldenBytes, testing::ValuesIn(peers()), vendor);

}  // namespace
}  // namespace lab::ros
