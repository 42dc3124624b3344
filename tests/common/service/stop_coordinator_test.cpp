#include "common/service/stop_coordinator.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace lab {
namespace {

constexpr std::int64_t kNow = 1'000'000'000'000;
constexpr std::int64_t kMs = 1000;

robot_status_t status(std::vector<std::int32_t> ids, std::int64_t stop_seq, bool stopped,
                      std::int8_t origin = robot_state_t::SIM) {
  robot_status_t message{};
  for (const std::int32_t id : ids) {
    robot_state_t robot{};
    robot.robot_id = id;
    robot.origin = origin;
    robot.stop_seq = stop_seq;
    robot.flags = stopped ? robot_state_t::FLAG_STOPPED : 0;
    message.robots.push_back(robot);
  }
  message.num_robots = static_cast<std::int32_t>(message.robots.size());
  return message;
}

TEST(StopCoordinator, RepeatsAStopAtTenHertzUntilTheLastRobotEchoes) {
  StopCoordinator dut;
  dut.take(status({1, 2}, 0, false), kNow);
  EXPECT_FALSE(dut.due(kNow));
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
  dut.stop("me", "fire", 77, kNow);
  const auto first = dut.due(kNow);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->seq, 77);
  EXPECT_EQ(first->clear, 0);
  EXPECT_EQ(first->reason, "fire");
  EXPECT_FALSE(dut.due(kNow + 99 * kMs));
  EXPECT_TRUE(dut.due(kNow + 100 * kMs));
  dut.take(status({1}, 77, true), kNow + 120 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  EXPECT_EQ(dut.unconfirmed(), std::vector<std::int32_t>{2});
  EXPECT_FALSE(dut.responseTime());
  EXPECT_TRUE(dut.due(kNow + 60'000 * kMs)) << "a stop is repeated as long as a robot is known";
  dut.take(status({2}, 77, true), kNow + 150 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopped);
  EXPECT_EQ(dut.responseTime(), 150 * kMs);
  EXPECT_FALSE(dut.due(kNow + 61'000 * kMs));
}

TEST(StopCoordinator, IgnoresEchoesOfOtherStopsOrWithoutTheLatch) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 76, true), kNow);
  EXPECT_FALSE(dut.confirmed());
  dut.take(status({1}, 77, false), kNow);
  EXPECT_FALSE(dut.confirmed());
  dut.take(status({1}, 77, true), kNow);
  EXPECT_TRUE(dut.confirmed());
}

TEST(StopCoordinator, RepeatsAStopForARobotThatLosesItsLatch) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 77, true), kNow + 50 * kMs);
  EXPECT_FALSE(dut.due(kNow + 900 * kMs));
  dut.take(status({1}, 0, false), kNow + 1000 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  EXPECT_TRUE(dut.due(kNow + 1000 * kMs));
  EXPECT_EQ(dut.responseTime(), 50 * kMs);
}

TEST(StopCoordinator, RepeatsAStopForRobotsThatHaveNotReportedYet) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 77, true), kNow);
  ASSERT_TRUE(dut.due(kNow));
  EXPECT_TRUE(dut.due(kNow + 200 * kMs));
  EXPECT_FALSE(dut.due(kNow + StopCoordinator::kDiscovery_us));
}

TEST(StopCoordinator, GivesUpWithoutAnyRobotAndConfirmsNothing) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  EXPECT_TRUE(dut.due(kNow + StopCoordinator::kTimeout_us));
  EXPECT_FALSE(dut.due(kNow + StopCoordinator::kTimeout_us + 200 * kMs));
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
}

TEST(StopCoordinator, ASilentExpectedRobotIsUnconfirmed) {
  StopCoordinator dut;
  dut.expect(9);
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 77, true), kNow);
  EXPECT_EQ(dut.unconfirmed(), std::vector<std::int32_t>{9});
}

TEST(StopCoordinator, DoesNotCountReplayedRobots) {
  StopCoordinator dut;
  dut.expect(1);
  dut.take(status({1}, 0, false, robot_state_t::REPLAY), kNow);
  dut.stop("me", "", 77, kNow);
  EXPECT_EQ(dut.total(), 0U);
}

TEST(StopCoordinator, TracksTheStopsOfOthersAndTheirRepetitionByTheLab) {
  StopCoordinator dut;
  dut.take(status({1, 2}, 0, false), kNow);
  robot_stop_t stop{};
  stop.sender = "lab_stop";
  stop.seq = 5;
  stop.robot_ids = {2};
  dut.take(stop, kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  EXPECT_EQ(dut.by(), "lab_stop");
  EXPECT_EQ(dut.total(), 1U);
  EXPECT_FALSE(dut.due(kNow)) << "requests of others are not repeated";
  dut.take(status({2}, 5, true), kNow + 30 * kMs);
  stop.sender = "lab";
  dut.take(stop, kNow + 40 * kMs);
  EXPECT_EQ(dut.by(), "lab_stop");
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopped);
}

TEST(StopCoordinator, ALateRepetitionDoesNotUndoTheRelease) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 77, true), kNow);
  dut.release("me", "", 78, kNow + 1000 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kReleasing);
  const auto clear = dut.due(kNow + 1000 * kMs);
  ASSERT_TRUE(clear);
  EXPECT_EQ(clear->clear, 1);
  robot_stop_t late{};
  late.sender = "lab";
  late.seq = 77;
  dut.take(late, kNow + 1010 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kReleasing);
  dut.take(status({1}, 78, false), kNow + 1050 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
}

TEST(StopCoordinator, CountsRobotsBeforeAnyRequest) {
  StopCoordinator dut;
  dut.take(status({1, 2}, 0, false), kNow);
  EXPECT_EQ(dut.total(), 2U);
  EXPECT_TRUE(dut.unconfirmed().empty());
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
  EXPECT_FALSE(dut.confirmed());
}

TEST(StopCoordinator, ARobotThatAppearsAfterTheReleaseIsFree) {
  StopCoordinator dut;
  dut.release("me", "", 78, kNow);
  dut.take(status({1}, 77, true), kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kReleasing);
  dut.take(status({1}, 78, false), kNow);
  dut.take(status({2}, 0, false), kNow + 1000 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
  EXPECT_EQ(dut.total(), 2U);
}

TEST(StopCoordinator, InfersAStopFromRobotsThatAreStopped) {
  StopCoordinator dut;
  dut.expect(3);
  dut.take(status({1, 2}, 77, true), kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  EXPECT_EQ(dut.unconfirmed(), std::vector<std::int32_t>{3});
  dut.take(status({3}, 76, true), kNow + 20 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopped);
  EXPECT_FALSE(dut.responseTime()) << "the time of the request is not known";
  EXPECT_FALSE(dut.due(kNow + 30 * kMs)) << "requests of others are not repeated";
  robot_stop_t late{};
  late.sender = "lab";
  late.seq = 77;
  dut.take(late, kNow + 40 * kMs);
  EXPECT_EQ(dut.by(), "lab");
  dut.release("me", "", 78, kNow + 50 * kMs);
  dut.take(status({1, 2, 3}, 78, false), kNow + 90 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
}

TEST(StopCoordinator, AnInferredStopEndsWithItsLastStoppedRobot) {
  StopCoordinator dut;
  dut.take(status({1, 2}, 77, true), kNow);
  dut.take(status({1}, 78, false), kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  dut.take(status({2}, 78, false), kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
  dut.take(status({4}, 77, true, robot_state_t::REPLAY), kNow);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree) << "replayed robots are ignored";
}

TEST(StopCoordinator, ANewRunKeepsOnlyItsOwnStop) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  dut.take(status({1}, 77, true), kNow);
  dut.newRun();
  dut.take(status({2}, 0, false), kNow + 1000 * kMs);
  EXPECT_EQ(dut.state(), StopCoordinator::State::kStopping);
  EXPECT_EQ(dut.unconfirmed(), std::vector<std::int32_t>{2});
  ASSERT_TRUE(dut.due(kNow + 1000 * kMs));
  dut.release("me", "", 78, kNow + 1100 * kMs);
  dut.take(status({2}, 78, false), kNow + 1200 * kMs);
  dut.newRun();
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
  robot_stop_t other{};
  other.sender = "lab_stop";
  other.seq = 80;
  dut.take(other, kNow + 1300 * kMs);
  dut.newRun();
  EXPECT_EQ(dut.state(), StopCoordinator::State::kFree);
}

TEST(StopCoordinator, TracksABoundedNumberOfRobotsAndThoseThatItExpects) {
  StopCoordinator dut;
  dut.stop("me", "", 77, kNow);
  std::vector<std::int32_t> ids(2 * StopCoordinator::kMostRobots);
  std::iota(ids.begin(), ids.end(), 1);
  dut.take(status(ids, 77, true), kNow);
  EXPECT_EQ(dut.total(), StopCoordinator::kMostRobots);
  dut.expect(-5);
  EXPECT_EQ(dut.unconfirmed(), std::vector<std::int32_t>{-5});
  dut.take(status({-5}, 77, true), kNow);
  EXPECT_TRUE(dut.confirmed());
}

TEST(StopCoordinator, FindsRobotsInAStopOfAMillionInAnyOrder) {
  StopCoordinator dut;
  dut.take(status({1, 2, 3}, 0, false), kNow);
  robot_stop_t stop{};
  stop.seq = 77;
  stop.robot_ids = {3, 900, 1};
  dut.take(stop, kNow);
  EXPECT_EQ(dut.unconfirmed(), (std::vector<std::int32_t>{1, 3}));
  // A walk along the list for each robot would take 2e11 comparisons.
  std::vector<std::int32_t> ids(10'000);
  std::iota(ids.begin(), ids.end(), 1);
  dut.take(status(ids, 0, false), kNow);
  stop.seq = 78;
  stop.robot_ids.resize(1'000'000);
  std::iota(stop.robot_ids.rbegin(), stop.robot_ids.rend(), 5'001);
  dut.take(stop, kNow);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(dut.total(), 5'000U);
}

}  // namespace
}  // namespace lab
