// Our endpoints against those of ROS 2 nodes, as rmw_cyclonedds of Humble and of Jazzy makes them,
// and against Fast DDS: which endpoints match, and why others do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/dds_gateway/peers/cdr.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {
namespace {

using ros::Float64;

const ros::RosType& kType = ros::rosType<Float64>();

/// How a kind of node is started, and what it publishes about its types.
struct Style {
  std::string name;
  std::vector<std::string> command;
  bool hash = true;
  bool xcdr2 = true;  ///< whether it can offer XCDR2
};

/// On a machine with a network card: ROS 2's setting that uses only the loopback interface, and the
/// files of docs/examples/ros2 that do the same for other versions (docs/ros2.md).
std::vector<Style> onLoopback() {
  const std::string folder = LAB_ROOT "/docs/examples/ros2/";
  const std::string file = "file://" + folder + "cyclonedds.xml";
  std::vector<Style> all = {{"Humble", {LAB_CYCLONE_PEER, "0", kHumble}, false},
                            {"HumbleFile", {LAB_CYCLONE_PEER, "0", file}, false},
                            {"JazzyFile", {LAB_CYCLONE_PEER, "0", kJazzy + file}}};
  if (std::string_view(LAB_FASTDDS_PEER) != "") {
    all.push_back({"FastDdsFile", {LAB_FASTDDS_PEER, "0", folder + "fastdds.xml"}, true, false});
  }
  return all;
}

/// These nodes use the network card; without a card they are found on the loopback interface too.
std::vector<Style> onAnyInterface() {
  std::vector<Style> all = {{"Jazzy", {LAB_CYCLONE_PEER, "0", kJazzy}}};
  if (std::string_view(LAB_FASTDDS_PEER) != "") {
    all.push_back({"FastDds", {LAB_FASTDDS_PEER, "0"}, true, false});
  }
  return all;
}

struct Profile {
  std::string name;
  Qos qos;
  std::string words;  ///< in the form that the peer program reads
};

std::vector<Profile> profiles() {
  return {{"default", ros::defaultQos(kType), ""},
          {"sensor", ros::sensorQos(kType), "besteffort depth=5"},
          {"latched", ros::latchedQos(kType, 3), "latched depth=3"}};
}

/// A pair of endpoints of one topic, and the expected result.
struct Pair {
  Profile ours;
  Profile theirs;
  std::string representation;
  std::string topic;
  std::set<std::string> reasons;  ///< policies that prevent a match; one of them is reported
};

std::vector<Pair> pairs(bool we_write, const Style& style) {
  std::vector<Pair> all;
  for (const Profile& ours : profiles()) {
    for (const Profile& theirs : profiles()) {
      const Qos& writer = we_write ? ours.qos : theirs.qos;
      const Qos& reader = we_write ? theirs.qos : ours.qos;
      for (const std::string representation : {"xcdr1", "both", "xcdr2"}) {
        if (representation != "xcdr1" && !style.xcdr2) continue;
        Pair pair{ours,
                  theirs,
                  representation,
                  "rt/" + ours.name + "/" + theirs.name + "/" + representation,
                  {}};
        if (reader.reliable && !writer.reliable) pair.reasons.insert("reliability");
        if (reader.latched && !writer.latched) pair.reasons.insert("durability");
        if (representation == "xcdr2") pair.reasons.insert("data representation");
        all.push_back(pair);
      }
    }
  }
  return all;
}

class Match : public testing::TestWithParam<Style> {
 protected:
  Match() : dut(0, localConfiguration(), "test"), peer(GetParam().command) {}

  void theirs(const std::string& what, const std::string& topic, const std::string& words) const {
    peer.say(what + " " + topic + " " + kType.descriptor->m_typename + " " + words +
             (GetParam().hash ? " hash=" + std::string(kType.hash) : ""));
  }

  /// Waits until both know of each other or of the refusal.
  template <class Endpoint>
  void expectFate(const Pair& pair, const Endpoint& endpoint) {
    ASSERT_TRUE(eventually([&] {
      return endpoint.matching().peers + endpoint.matching().refused > 0;
    })) << pair.topic;
    const Matching matching = endpoint.matching();
    if (pair.reasons.empty()) {
      EXPECT_EQ(matching.peers, 1) << pair.topic;
      EXPECT_EQ(matching.refused, 0) << pair.topic << ": " << matching.why;
      EXPECT_TRUE(peer.says("matched " + pair.topic + " 1")) << pair.topic;
    } else {
      EXPECT_EQ(matching.peers, 0) << pair.topic;
      EXPECT_EQ(matching.refused, 1) << pair.topic;
      EXPECT_TRUE(pair.reasons.contains(matching.why)) << pair.topic << ": " << matching.why;
    }
  }

  Domain dut;
  Peer peer;
  EventDescriptor waker;
};

TEST_P(Match, OurWritersMatchTheirReaders) {
  const std::vector<Pair> all = pairs(true, GetParam());
  std::vector<Writer> writers;
  for (const Pair& pair : all) {
    writers.emplace_back(dut, *kType.descriptor, pair.topic, pair.ours.qos);
    theirs("reader", pair.topic, pair.theirs.words + " representation=" + pair.representation);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    expectFate(all[i], writers[i]);
    if (!all[i].reasons.empty()) continue;
    const Float64 sample{static_cast<double>(i)};
    const std::string payload = hexOf(ros::Cdr().f64(static_cast<double>(i)).payload());
    EXPECT_TRUE(eventually([&] {  // repeated: best effort loses early samples
      if (peer.got(all[i].topic).empty()) static_cast<void>(writers[i].write(&sample));
      return !peer.got(all[i].topic).empty();
    })) << all[i].topic;
    EXPECT_EQ(peer.got(all[i].topic).at(0), payload);
  }
}

TEST_P(Match, TheirWritersMatchOurReaders) {
  const std::vector<Pair> all = pairs(false, GetParam());
  std::vector<std::unique_ptr<Reader>> readers;
  for (const Pair& pair : all) {
    readers.push_back(
        std::make_unique<Reader>(dut, *kType.descriptor, pair.topic, pair.ours.qos, waker));
    theirs("writer", pair.topic, pair.theirs.words + " representation=" + pair.representation);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    expectFate(all[i], *readers[i]);
    if (!all[i].reasons.empty()) continue;
    const double value = static_cast<double>(i) + 0.5;
    double got = 0;
    EXPECT_TRUE(eventually([&] {
      peer.say("write " + all[i].topic + " " + hexOf(ros::Cdr().f64(value).payload()));
      return readers[i]->take(1, [&](const void* sample, WriterId /*writer*/) {
        got = static_cast<const Float64*>(sample)->data;
      }) > 0;
    })) << all[i].topic;
    EXPECT_EQ(got, value);
  }
}

TEST_P(Match, LateReadersGetLatchedSamples) {
  Writer writer(dut, *kType.descriptor, "rt/late", ros::latchedQos(kType, 3));
  for (const double value : {1, 2, 3, 4, 5}) {
    const Float64 sample{value};
    ASSERT_TRUE(writer.write(&sample));
  }
  theirs("reader", "rt/late", "latched depth=10");
  std::vector<std::string> last;
  for (const double value : {3, 4, 5}) last.push_back(hexOf(ros::Cdr().f64(value).payload()));
  EXPECT_TRUE(eventually([&] { return peer.got("rt/late").size() >= last.size(); }));
  EXPECT_EQ(peer.got("rt/late"), last);
}

TEST_P(Match, OurLateReaderGetsLatchedSamples) {
  theirs("writer", "rt/late", "latched depth=3");
  for (const double value : {1, 2, 3, 4, 5}) {
    peer.say("write rt/late " + hexOf(ros::Cdr().f64(value).payload()));
  }
  peer.say("sync written");
  ASSERT_TRUE(peer.says("synced written"));
  Reader reader(dut, *kType.descriptor, "rt/late", ros::latchedQos(kType, 10), waker);
  std::vector<double> got;
  EXPECT_TRUE(eventually([&] {
    reader.take(10, [&](const void* sample, WriterId /*writer*/) {
      got.push_back(static_cast<const Float64*>(sample)->data);
    });
    return got.size() >= 3;
  }));
  EXPECT_THAT(got, testing::ElementsAre(3, 4, 5));
}

// A sleeping computer delays no other reader, and gets the newest sample when it wakes.
TEST_P(Match, AFrozenReaderDoesNotBlockTheWriter) {
  const ros::RosType& type = ros::rosType<ros::PoseArray>();
  std::vector<ros::Pose> poses(200);
  std::string frame;
  ros::PoseArray sample{{{0, 0}, frame.data()}, {}};
  sample.poses._buffer = poses.data();
  sample.poses._length = sample.poses._maximum = static_cast<std::uint32_t>(poses.size());
  Writer writer(dut, *type.descriptor, "rt/poses", ros::defaultQos(type));
  peer.say("reader rt/poses " + std::string(type.descriptor->m_typename));
  ASSERT_TRUE(peer.says("matched rt/poses 1"));
  ASSERT_TRUE(eventually([&] { return writer.matching().peers == 1; }));
  peer.freeze();
  std::chrono::steady_clock::duration longest{};
  for (int i = 0; i < 500; ++i) {
    sample.header.stamp.sec = i;
    const auto start = std::chrono::steady_clock::now();
    static_cast<void>(writer.write(&sample));
    longest = std::max(longest, std::chrono::steady_clock::now() - start);
  }
  peer.thaw();
  EXPECT_LT(longest, std::chrono::seconds(1));  // hang check; benchmarks/ measures
  EXPECT_EQ(writer.written() + writer.timeouts(), 500);
  const std::string last = "00010003f3010000";  // header, then 499
  EXPECT_TRUE(eventually([&] {
    const std::vector<std::string> got = peer.got("rt/poses");
    return !got.empty() && got.back().substr(8, 8) == last.substr(8);
  }));
}

// A gateway must not receive its own samples, because it would forward them in a loop.
TEST_P(Match, OurOwnSamplesAreNotReceived) {
  Reader reader(dut, *kType.descriptor, "rt/own", ros::defaultQos(kType), waker);
  Writer writer(dut, *kType.descriptor, "rt/own", ros::defaultQos(kType));
  theirs("reader", "rt/own", "");
  ASSERT_TRUE(peer.says("matched rt/own 1"));
  ASSERT_TRUE(eventually([&] { return writer.matching().peers == 1; }));
  const Float64 sample{1};
  ASSERT_TRUE(writer.write(&sample));
  ASSERT_TRUE(eventually([&] { return !peer.got("rt/own").empty(); }));
  EXPECT_EQ(reader.take(1, [](const void*, WriterId) {}), 0);
}

void PrintTo(const Style& style, std::ostream* to) { *to << style.name; }

INSTANTIATE_TEST_SUITE_P(Loopback, Match, testing::ValuesIn(onLoopback()),
                         [](const auto& style) { return style.param.name; });
INSTANTIATE_TEST_SUITE_P(AnyInterface, Match, testing::ValuesIn(onAnyInterface()),
                         [](const auto& style) { return style.param.name; });

}  // namespace
}  // namespace lab::dds
