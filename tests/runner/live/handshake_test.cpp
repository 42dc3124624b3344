#include "runner/live/handshake.hpp"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

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

/// The robots that a command turns in one direction.
std::set<std::int32_t> turning(const robot_command_t& command, bool left) {
  std::set<std::int32_t> found;
  for (const robot_order_t& order : command.orders) {
    if (order.mode != robot_order_t::DRIVE) continue;
    EXPECT_NE(order.wheel_left, 0);
    EXPECT_EQ(order.wheel_left, -order.wheel_right);
    if ((order.wheel_right > 0) == left) {
      found.insert(order.robot_ids.begin(), order.robot_ids.end());
    }
  }
  return found;
}

std::set<std::int32_t> turning(const robot_command_t& command) {
  std::set<std::int32_t> found = turning(command, true);
  found.merge(turning(command, false));
  return found;
}

std::set<std::int32_t> standing(const robot_command_t& command) {
  std::set<std::int32_t> robots;
  for (const robot_order_t& order : command.orders) {
    if (order.mode != robot_order_t::STAND) continue;
    robots.insert(order.robot_ids.begin(), order.robot_ids.end());
  }
  return robots;
}

const auto kObeys = [](std::int32_t) { return true; };

TEST(Handshake, IsNotNeededWithoutACamera) {
  Experiment experiment = experimentWith({{1, Body::kSim}});
  experiment.camera.tracker = Tracker::kSimPoses;
  EXPECT_FALSE(Handshake(experiment).needed());
  experiment.camera.tracker = Tracker::kCamera;
  EXPECT_TRUE(Handshake(experiment).needed());
  experiment.camera.handshake = false;
  EXPECT_FALSE(Handshake(experiment).needed());
}

TEST(Handshake, TurnsEveryRobotByAWordOfItsOwn) {
  const Experiment experiment =
      experimentWith({{1, Body::kSim}, {4, Body::kWire}, {9, Body::kFirmware}});
  Handshake handshake(experiment);
  std::map<std::int32_t, std::string> words;
  std::int64_t now = 0;
  for (; !handshake.done() && now < 100 * kSecond_us; now += 20'000) {
    if (!handshake.advance(now, kObeys)) continue;
    const std::set<std::int32_t> left = turning(handshake.command(), true);
    if (turning(handshake.command()).empty()) break;  // the end of the first pass
    EXPECT_THAT(turning(handshake.command()), ElementsAre(1, 4, 9));
    for (const std::int32_t id : {1, 4, 9}) words[id] += left.contains(id) ? 'l' : 'r';
  }
  EXPECT_LT(now, 5 * kSecond_us);
  EXPECT_THAT(standing(handshake.command()), ElementsAre(1, 4, 9));
  EXPECT_NE(words[1], words[4]);
  EXPECT_NE(words[1], words[9]);
  EXPECT_NE(words[4], words[9]);
}

TEST(Handshake, EndsAsSoonAsAllRobotsAreKnown) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  ASSERT_TRUE(handshake.advance(0, kObeys));
  handshake.see(frameWith({1}));
  EXPECT_FALSE(handshake.advance(20'000, kObeys));
  EXPECT_FALSE(handshake.done());
  handshake.see(frameWith({2}));  // robot 1 was not detected in this frame
  EXPECT_FALSE(handshake.advance(40'000, kObeys));
  EXPECT_TRUE(handshake.done());
  EXPECT_THAT(handshake.unknown(), IsEmpty());
}

TEST(Handshake, ARobotThatIsNoLongerNamedIsNotKnown) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  ASSERT_TRUE(handshake.advance(0, kObeys));
  handshake.see(frameWith({1}));
  tracked_frame_t later = frameWith({2});
  later.utime = kSecond_us;
  handshake.see(later);
  EXPECT_FALSE(handshake.advance(20'000, kObeys));
  EXPECT_FALSE(handshake.done());
}

TEST(Handshake, RobotsThatTheTrackerKnowsStand) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  handshake.see(frameWith({1}));
  ASSERT_TRUE(handshake.advance(0, kObeys));
  EXPECT_THAT(turning(handshake.command()), ElementsAre(2));
  EXPECT_THAT(standing(handshake.command()), ElementsAre(1));
}

TEST(Handshake, TriesUnrecognisedRobotsASecondTime) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}, {3, Body::kSim}});
  Handshake handshake(experiment);
  std::vector<std::set<std::int32_t>> passes;
  std::int64_t now = 0;
  for (; !(now > 0 && handshake.done()) && now < 100 * kSecond_us; now += 20'000) {
    if (handshake.advance(now, kObeys)) {
      const std::set<std::int32_t> turned = turning(handshake.command());
      if (!turned.empty() && (passes.empty() || passes.back() != turned)) passes.push_back(turned);
    }
    if (now > 2 * kSecond_us) {
      tracked_frame_t frame = frameWith({2});
      frame.utime = now;
      handshake.see(frame);
    }
  }
  EXPECT_THAT(passes, ElementsAre(std::set{1, 2, 3}, std::set{1, 3}));
  EXPECT_THAT(handshake.unknown(), UnorderedElementsAre(1, 3));
  EXPECT_LT(now, 13 * kSecond_us);
}

TEST(Handshake, WaitsForARobotThatBootsSlowly) {
  const Experiment experiment = experimentWith({{1, Body::kWire}, {2, Body::kWire}});
  const auto only_one = [](std::int32_t id) { return id == 1; };
  Handshake handshake(experiment);
  ASSERT_TRUE(handshake.advance(0, only_one));
  EXPECT_FALSE(handshake.advance(9 * kSecond_us, only_one));
  EXPECT_FALSE(handshake.advance(9 * kSecond_us + 1, kObeys));
  EXPECT_TRUE(handshake.advance(10 * kSecond_us, kObeys));
}

TEST(Handshake, ASilentRobotDoesNotDelayEveryRound) {
  const Experiment experiment = experimentWith({{1, Body::kWire}, {2, Body::kWire}});
  const auto only_one = [](std::int32_t id) { return id == 1; };
  Handshake handshake(experiment);
  std::int64_t now = 0;
  for (; !(now > 0 && handshake.done()) && now < 100 * kSecond_us; now += 20'000) {
    static_cast<void>(handshake.advance(now, only_one));
    tracked_frame_t frame = frameWith({1});
    frame.utime = now;
    if (now > 12 * kSecond_us) handshake.see(frame);
  }
  EXPECT_THAT(handshake.unknown(), ElementsAre(2));
  EXPECT_LT(now, 25 * kSecond_us);
}

TEST(Handshake, EveryRobotTurnsInBothDirections) {
  const Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSim}});
  Handshake handshake(experiment);
  std::set<std::int32_t> left;
  std::set<std::int32_t> right;
  for (std::int64_t now = 0; now < 3 * kSecond_us; now += 20'000) {
    static_cast<void>(handshake.advance(now, kObeys));
    left.merge(turning(handshake.command(), true));
    right.merge(turning(handshake.command(), false));
  }
  EXPECT_THAT(left, ElementsAre(1, 2));
  EXPECT_THAT(right, ElementsAre(1, 2));
}

TEST(Handshake, TurnsOnlyRobotsThatTheCameraCanSee) {
  Experiment experiment = experimentWith({{1, Body::kSim}, {2, Body::kSerial}, {3, Body::kReplay}});
  Handshake painted(experiment);
  ASSERT_TRUE(painted.advance(0, kObeys));
  EXPECT_THAT(turning(painted.command()), ElementsAre(1));
  experiment.camera.source = "/dev/video0";
  Handshake real(experiment);
  ASSERT_TRUE(real.advance(0, kObeys));
  EXPECT_THAT(turning(real.command()), ElementsAre(2));
}

}  // namespace
}  // namespace lab::runner
