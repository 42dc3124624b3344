// A running gateway: topics that follow the lab's messages and the topic mapping, and invalid bytes
// on topics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/clock_t.hpp>
#include <string>
#include <vector>

#include "tests/dds_gateway/peers/cdr.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/dds_gateway/peers/peer_loop.hpp"
#include "tests/dds_gateway/ros/ros_gateway_fixture.hpp"

namespace lab::gateway {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kThen = 1'700'000'000'000'000;  // [us]

TEST(RosTopics, ClockCarriesTheLabsTime) {
  RosGatewayFixture dut;
  RosReader<ros::Clock> reader(dut.domain(), "/clock");
  EXPECT_FALSE(dut.spin(1.5, [&] { return reader.matching().peers > 0; })) << "in real time none";
  constexpr std::int64_t kStep = 1'250'000;  // [us]
  std::int64_t sent = -kStep;
  std::vector<std::int64_t> got;
  const auto send = [&] {
    clock_t clock{};
    clock.utime = kThen + (sent += kStep);
    dut.node().publish(channels::kClock, clock);
  };
  const auto heardTheLast = [&] {
    reader.take([&](const ros::Clock& message) {
      got.push_back(std::int64_t{message.clock.sec} * 1'000'000 + message.clock.nanosec / 1000 -
                    kThen);
    });
    return !got.empty() && got.back() == sent;
  };
  // The gateway opens the topic at the first message, and the reader misses what comes before it
  // is known there.
  ASSERT_TRUE(dut.spinActing(60, 0.02, send, [&] { return heardTheLast() || !got.empty(); }));
  ASSERT_TRUE(dut.spinActing(60, 1, send, heardTheLast));
  got.clear();
  std::vector<std::int64_t> expected;
  // The topic keeps ten messages: the next is sent when the former has arrived.
  for (int i = 0; i < 5; ++i) {
    send();
    expected.push_back(sent);
    ASSERT_TRUE(dut.spin(60, heardTheLast));
  }
  EXPECT_EQ(got, expected) << "each once, in order";
}

analysis_t analysisOf(std::int32_t robot, double d_r) {
  analysis_t analysis{};
  analysis.utime = kThen;
  analysis.robot_id = robot;
  analysis.program.name = "abp 2";
  curve_t curve{};
  curve.name = "msd";
  curve.unit = "m^2";
  curve.num_lags = 2;
  curve.lag = {0.1F, 0.2F};
  curve.value = curve.sigma = curve.exact = curve.paper = {1, 2};
  curve.windows = {10, 5};
  curve.biased = {0, 1};
  analysis.curves = {curve};
  analysis.num_curves = 1;
  estimate_t estimate{};
  estimate.name = "D_r";
  estimate.unit = "rad\xC2\xB2/s";
  estimate.value = d_r;
  estimate.note = "caf\xE9";  // Latin-1
  analysis.estimates = {estimate};
  analysis.num_estimates = 1;
  return analysis;
}

TEST(RosTopics, ALateReaderGetsTheLastAnalysis) {
  RosGatewayFixture dut;
  for (const double d_r : {0.5, 0.75}) {  // the last one counts
    for (const std::int32_t robot : {-1, 2}) {
      analysis_t analysis = analysisOf(robot, d_r);
      dut.node().publish(channels::kAnalysis, analysis);
    }
  }
  dut.spin(1);
  RosReader<ros::Analysis> pool(dut.domain(), "/lab/analysis/abp_2", true);
  RosReader<ros::Analysis> robot(dut.domain(), "/lab/robot2/analysis/abp_2", true);
  std::vector<std::int32_t> ids;
  const auto look = [&](const ros::Analysis& message) {
    ids.push_back(message.robot_id);
    EXPECT_EQ(message.header.stamp.sec, 1'700'000'000);
    ASSERT_EQ(message.estimates._length, 1U);
    EXPECT_EQ(message.estimates._buffer[0].value, 0.75);
    EXPECT_STREQ(message.estimates._buffer[0].unit, "rad\u00B2/s");
    EXPECT_STREQ(message.estimates._buffer[0].note, "caf\uFFFD");
    ASSERT_EQ(message.curves._length, 1U);
    ASSERT_EQ(message.curves._buffer[0].lag._length, 2U);
    EXPECT_TRUE(message.curves._buffer[0].biased._buffer[1]);
  };
  dut.spin(10, [&] {
    pool.take(look);
    robot.take(look);
    return ids.size() >= 2;
  });
  dut.spin(0.3);
  pool.take(look);
  robot.take(look);
  EXPECT_THAT(ids, testing::UnorderedElementsAre(-1, 2)) << "one each";
}

/// Each program had a topic, and each sender of SERVICE_STATUS an entry, without end.
TEST(RosTopics, ProgramsAndServicesWithoutEndAreBounded) {
  RosGatewayFixture dut;
  bool noted = false;
  for (int i = 0; i < 600; ++i) {
    if (i < 150) {
      analysis_t analysis = analysisOf(-1, 0.5);
      analysis.program.name = "flood" + std::to_string(i);
      dut.node().publish(channels::kAnalysis, analysis);
    }
    dut.reportService("flood" + std::to_string(i));
    if (i % 10 != 0) continue;
    dut.spin(0.05);  // the socket's buffer is not what bounds them
    noted =
        noted || dut.lastError().find("ANALYSIS of more than 100 programs") != std::string::npos;
  }
  analysis_t own = analysisOf(-1, 0.5);
  own.program.name = "straight";
  dut.node().publish(channels::kAnalysis, own);
  const std::string text = dut.diagnostics();
  const auto count = [&text](const std::string& words) {
    int found = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(count("  /lab/analysis/flood"), 98) << "and the two of the experiment";
  EXPECT_EQ(count("  /lab/analysis/straight"), 1);
  EXPECT_GT(count("lab: flood"), 490);
  EXPECT_LE(count("lab: flood"), 500);
  EXPECT_TRUE(noted);
}

TEST(RosTopics, TheMappingDeniesRenamesAndThins) {
  RosGatewayFixture dut(withGatewayLine("mapping = \"mapping.toml\""), false, R"(
fileversion = 1
[[rules]]
topic = "/lab/(robot[0-9]+)/pose"
rename = "/fleet/$1/pose"
rate_hz = 10
[[rules]]
topic = "/lab/robot2/odom"
allow = false
)");
  RosReader<ros::PoseStamped> renamed(dut.domain(), "/fleet/robot1/pose");
  RosReader<ros::PoseStamped> old_name(dut.domain(), "/lab/robot1/pose");
  RosReader<ros::Odometry> passing(dut.domain(), "/lab/robot1/odom");
  RosReader<ros::Odometry> denied(dut.domain(), "/lab/robot2/odom");
  int poses = 0;
  int odometry = 0;
  int nothing = 0;
  const auto take = [&] {
    poses += renamed.take([](const ros::PoseStamped&) {});
    odometry += passing.take([](const ros::Odometry&) {});
    nothing += old_name.take([](const ros::PoseStamped&) {});
    nothing += denied.take([](const ros::Odometry&) {});
  };
  // 50 Hz of the lab's time: 1 frame that makes the topics, and 150 in the 3 s after it.
  std::int64_t number = 0;
  const auto publish = [&] {
    auto frame = frameOf(2, kThen + 20'000 * number, number);
    ++number;
    dut.node().publish(channels::kTrackedFrame, frame);
  };
  publish();
  ASSERT_TRUE(
      dut.spin(10, [&] { return renamed.matching().peers == 1 && passing.matching().peers == 1; }));
  dut.spin(0.2);
  take();  // the first is latched
  poses = odometry = 0;
  dut.spinActing(30, 0.01, publish, [&] {
    take();
    return number == 151;
  });
  dut.spin(0.5, [&] {
    take();
    return false;
  });
  EXPECT_EQ(odometry, 150) << "every one";
  EXPECT_EQ(poses, 30) << "10 Hz of 3 s";
  EXPECT_EQ(nothing, 0);
  EXPECT_EQ(old_name.matching().peers + denied.matching().peers, 0);
  dut.endCommandByHand();
  EXPECT_THAT(dut.diagnostics(),
              AllOf(Not(HasSubstr("lab_mark")),
                    HasSubstr("/fleet/robot1/pose: readers 1, in 151, out 31, thinned 120"),
                    HasSubstr("/lab/robot1/odom: readers 1, in 151, out 151, thinned 0"),
                    Not(HasSubstr("/lab/robot1/pose")), Not(HasSubstr("/lab/robot2/odom"))));
}

TEST(RosTopics, TwoTopicsOfOneNameAreReportedAndTheOthersContinue) {
  // The experiment has one robot; the conflict of the second appears when it is first seen.
  std::string experiment = withGatewayLine("mapping = \"mapping.toml\"");
  const std::size_t second = experiment.find("[[robots]]\nid = 2");
  experiment.erase(second, experiment.find("[programs.abp]") - second);
  RosGatewayFixture dut(experiment, false, R"(fileversion = 1
[[rules]]
topic = "/lab/robot[0-9]+/pose"
rename = "/pose"
)");
  RosReader<ros::PoseStamped> reader(dut.domain(), "/pose");
  RosReader<ros::Odometry> second_odom(dut.domain(), "/lab/robot2/odom");
  std::int64_t number = 0;
  double x = 0;
  int odometry = 0;
  EXPECT_TRUE(dut.spinActing(
      10, 0.02,
      [&] {
        auto frame = frameOf(2, dut.now(), ++number);
        dut.node().publish(channels::kTrackedFrame, frame);
      },
      [&] {
        reader.take([&](const ros::PoseStamped& pose) { x = std::max(x, pose.pose.position.x); });
        odometry += second_odom.take([](const ros::Odometry&) {});
        return odometry > 10 && x > 0 && !dut.lastError().empty();
      }));
  EXPECT_DOUBLE_EQ(x, 0.1) << "of robot 1";
  EXPECT_THAT(dut.lastError(),
              HasSubstr("mapping.toml:4: rules[0].rename: found that /lab/robot1/pose and "
                        "/lab/robot2/pose both become \"/pose\""));
}

TEST(RosTopics, GarbageOnOneRobotsTopicDoesNotAffectTheOther) {
  RosGatewayFixture dut(kTwoRobots, true);
  const std::string topic = "rt/lab/robot1/cmd_vel";
  dds::Peer stranger({LAB_CYCLONE_PEER, "41", dds::kHumble});
  stranger.say("writer " + topic + " geometry_msgs::msg::dds_::Twist_ depth=1000");
  RosWriter<ros::Twist> teleop(dut.domain(), "/lab/robot2/cmd_vel");
  ros::Twist forward{};
  forward.linear.x = 0.05;
  ASSERT_TRUE(dut.spinActing(
      10, 0.05, [&] { teleop.write(forward); },
      [&] { return dut.driven(2, 0.05) && dut.inScript(1); }));
  ASSERT_TRUE(stranger.says("matched " + topic + " 1"));
  EXPECT_THAT(dut.lastError(), Not(HasSubstr("not messages of their topic")));

  dds::Payload noise(300);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::uint8_t>(i * 37 + 11);
  const std::vector<dds::Payload> garbage{ros::Cdr().u8(1).payload(),
                                          ros::Cdr().f64(0.1).f64(0.2).payload(),  // too short
                                          {0, 1, 0, 0},                            // only a header
                                          ros::Cdr().text("forward").payload()};
  int sent = 0;
  int away = 0;
  std::string error;
  dut.spinActing(
      3, 0.05,
      [&] {
        teleop.write(forward);
        // Last, bytes after which Cyclone receives nothing more from this participant.
        const dds::Payload& one =
            sent < 40 ? garbage[static_cast<std::size_t>(sent) % garbage.size()] : noise;
        stranger.say("write " + topic + " " + dds::hexOf(one));
        ++sent;
        away += dut.driven(2, 0.05) && dut.inScript(1) ? 0 : 1;
      },
      [&] {
        if (error.empty() && dut.lastError().find("not messages") != std::string::npos) {
          error = dut.lastError();
        }
        return false;
      });
  EXPECT_GE(sent, 45);
  EXPECT_EQ(away, 0) << "of " << sent;
  EXPECT_THAT(error, AllOf(HasSubstr("not messages of their topic, dropped: "),
                           HasSubstr("deserialization " + topic)));
  const std::string text = dut.diagnostics();
  const std::string row = "malformed, dropped: ";
  ASSERT_THAT(text, HasSubstr(row));
  EXPECT_GE(std::stoi(text.substr(text.find(row) + row.size())), 40);
  EXPECT_THAT(text, HasSubstr("received payloads that are not messages of their topic"));
  EXPECT_THAT(text, HasSubstr("Cyclone DDS: malformed packet"));

  // A valid publisher is received on the same topic.
  RosWriter<ros::Twist> proper(dut.domain(), "/lab/robot1/cmd_vel");
  EXPECT_TRUE(dut.spinActing(
      10, 0.05, [&] { proper.write(forward); }, [&] { return dut.driven(1, 0.05); }));
}

}  // namespace
}  // namespace lab::gateway
