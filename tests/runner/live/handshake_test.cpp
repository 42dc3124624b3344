#include "runner/live/handshake.hpp"

#include <gmock/gmock.h>

#include "common/experiment/experiment.hpp"

namespace lab::runner {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kSecond_us = 1'000'000;

Experiment experimentWith(std::vector<std::pair<std::int32_t, Body>> robots) {
  Experiment experiment;
  experiment.camera.tracker = Tracker::kCamera;
  for (const auto& [id, body] : robots) {
    RobotSpec robot;
    robot.id = id;
    robot.body = body;
    experiment.robots.push_back(robot);
  }
  return experiment;
}

tracked_frame_t frameWith(const std::vector<std::int32_t>& ids) {
  tracked_frame_t frame{};
  for (const std::int32_t id : ids) {
    tracked_pose_t pose{};
    pose.robot_id = id;
    frame.robots.push_back(pose);
  }
  return frame;
}

/// The robot that a command turns; 0 if none, -1 if several.
std::int32_t turning(const robot_command_t& command) {
  std::int32_t found = 0;
  for (const robot_order_t& order : command.orders) {
    if (order.mode != robot_order_t::DRIVE) continue;
    if (order.robot_ids.size() != 1 || found != 0) return -1;
    EXPECT_NE(order.wheel_left, 0);
    EXPECT_EQ(order.wheel_left, -order.wheel_right);
    found = order.robot_ids.front();
  }
  return found;
}

std::size_t standing(const robot_command_t& command) {
  std::size_t robots = 0;
  for (const robot_order_t& order : command.orders) {
    if (order.mode == robot_order_t::STAND) robots += order.robot_ids.size();
  }
  return robots;
}

const auto kObeys = [](std::int32_t) { return true; };
const auto kIgnores = [](std::int32_t) { return false; };

TEST(Handshake, IsNotNeededWithoutACamera) {
  Experiment experiment = experimentWith({{1, Body::kSim}});
  experiment.camera.tracker = Tracker::kSimPoses;
  EXPECT_FALSE(Handshake(experiment).needed());
  experiment.camera.tracker = Tracker::kCamera;
  EXPECT_TRUE(Handshake(experiment).needed());
  experiment.camera.handshake = false;
  EXPECT_FALSE(Handshake(experiment).needed());
}

TEST(Handshake, TurnsOneRobotAfterTheOtherWhileTheOthersStand) {
  const Experiment experiment =
      experimentWith({{1, Body::kSim}, {4, Body::kWire}, {9, Body::kFirmware}});
  Handshake handshake(experiment);
  ASSERT_TRUE(handshake.advance(0, kObeys));
  std::vector<std::int32_t> turned;
  for (std::int64_t now = 0; !handshake.done() && now < 100 * kSecond_us; now += 20'000) {
    EXPECT_EQ(standing(handshake.command()), 2U);
    turned.push_back(turning(handshake.command()));
    handshake.see(frameWith({turned.back()}));
    static_cast<void>(handshake.advance(now, kObeys));
  }
  EXPECT_THAT(turned, ElementsAre(1, 4, 9));
  EXPECT_THAT(handshake.unknown(), IsEmpty());
}

TEST(Handshake, SkipsRobotsThatTheTrackerKnows) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  handshake.see(frameWith({1}));
  ASSERT_TRUE(handshake.advance(0, kObeys));
  EXPECT_EQ(turning(handshake.command()), 2);
}

TEST(Handshake, TriesAnUnrecognisedRobotASecondTimeAtTheEnd) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  std::vector<std::int32_t> turned;
  std::int64_t now = 0;
  for (; !(now > 0 && handshake.done()) && now < 100 * kSecond_us; now += 20'000) {
    if (handshake.advance(now, kObeys) &&
        (turned.empty() || turned.back() != turning(handshake.command()))) {
      turned.push_back(turning(handshake.command()));
    }
    if (!turned.empty() && turned.back() == 2) handshake.see(frameWith({2}));
  }
  EXPECT_THAT(turned, ElementsAre(1, 2, 1));
  EXPECT_THAT(handshake.unknown(), ElementsAre(1));
  EXPECT_LT(now, 7 * kSecond_us);
}

TEST(Handshake, WaitsForARobotThatBootsSlowly) {
  const Experiment experiment = experimentWith({{1, Body::kWire}});
  Handshake handshake(experiment);
  ASSERT_TRUE(handshake.advance(0, kIgnores));
  EXPECT_FALSE(handshake.advance(9 * kSecond_us, kIgnores));
  EXPECT_FALSE(handshake.advance(9 * kSecond_us + 1, kObeys));
  EXPECT_EQ(handshake.unknown().size(), 0U);
  static_cast<void>(handshake.advance(11 * kSecond_us, kObeys));
  EXPECT_TRUE(handshake.advance(13 * kSecond_us, kObeys));
}

TEST(Handshake, TurnsInBothDirections) {
  const Experiment experiment = experimentWith({{1, Body::kSim}});
  Handshake handshake(experiment);
  int changes = 0;
  double last = 0;
  for (std::int64_t now = 0; now < 2 * kSecond_us; now += 20'000) {
    static_cast<void>(handshake.advance(now, kObeys));
    const double left = handshake.command().orders.back().wheel_left;
    if (left != last) ++changes;
    last = left;
  }
  EXPECT_EQ(changes, 4);
}

TEST(Handshake, TurnsOnlyRobotsThatTheCameraCanSee) {
  Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSerial}, {3, Body::kReplay}});
  Handshake painted(experiment);
  ASSERT_TRUE(painted.advance(0, kObeys));
  EXPECT_EQ(turning(painted.command()), 1);
  experiment.camera.source = "/dev/video0";
  Handshake real(experiment);
  ASSERT_TRUE(real.advance(0, kObeys));
  EXPECT_EQ(turning(real.command()), 2);
}

}  // namespace
}  // namespace lab::runner
