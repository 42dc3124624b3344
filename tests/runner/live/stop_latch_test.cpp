#include "runner/live/stop_latch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <lab/robot_stop_t.hpp>
#include <vector>

namespace lab::runner::stop_latch_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

Experiment threeRobots() {
  Experiment experiment;
  experiment.robots.resize(3);
  for (int i = 0; i < 3; ++i) experiment.robots[static_cast<std::size_t>(i)].id = i + 1;
  return experiment;
}

robot_stop_t stopOf(std::int64_t seq, bool clear, const std::vector<std::int32_t>& robots) {
  robot_stop_t stop{};
  stop.seq = seq;
  stop.clear = clear ? 1 : 0;
  stop.robot_ids = robots;
  return stop;
}

TEST(StopLatch, RepeatsAStopForTheRobotsThatWereNotReleased) {
  StopLatch dut(threeRobots());

  EXPECT_TRUE(dut.take(stopOf(10, false, {})));
  EXPECT_TRUE(dut.take(stopOf(11, true, {2})));

  const std::vector<robot_stop_t> stops = dut.inForce(99);
  ASSERT_THAT(stops, SizeIs(1));
  EXPECT_EQ(stops[0].seq, 10);
  EXPECT_EQ(stops[0].utime, 99);
  EXPECT_THAT(stops[0].robot_ids, ElementsAre(1, 3));
}

TEST(StopLatch, IgnoresARepeatedMessage) {
  StopLatch dut(threeRobots());

  EXPECT_TRUE(dut.take(stopOf(10, false, {})));
  EXPECT_TRUE(dut.take(stopOf(11, true, {})));
  EXPECT_FALSE(dut.take(stopOf(10, false, {})));

  EXPECT_THAT(dut.inForce(99), IsEmpty());
}

TEST(StopLatch, IsBoundedWhenStopsOfRobotsThatDoNotExistFloodTheBus) {
  StopLatch dut(threeRobots());
  std::int64_t seq = 1;
  for (std::int32_t id = 1000; id < 6000; ++id) EXPECT_TRUE(dut.take(stopOf(seq++, false, {id})));
  EXPECT_TRUE(dut.refused());
  EXPECT_TRUE(dut.take(stopOf(seq++, false, {2})));

  const std::vector<robot_stop_t> stops = dut.inForce(99);

  EXPECT_LE(stops.size(), StopLatch::kMostMessages);
  std::size_t robots = 0;
  for (const robot_stop_t& stop : stops) {
    EXPECT_EQ(static_cast<std::size_t>(stop.num_robots), stop.robot_ids.size());
    robots += stop.robot_ids.size();
  }
  EXPECT_EQ(robots, StopLatch::kMostOthers + 1);
  EXPECT_THAT(stops.back().robot_ids, ElementsAre(2)) << "the newest keeps its own message";
}

TEST(StopLatch, KeepsEveryStopOfTheRobotsOfTheRun) {
  Experiment experiment;
  experiment.robots.resize(250);
  for (int i = 0; i < 250; ++i) experiment.robots[static_cast<std::size_t>(i)].id = i + 1;
  StopLatch dut(experiment);
  for (std::int32_t id = 1; id <= 250; ++id) dut.take(stopOf(id, false, {id}));

  std::vector<std::int32_t> stopped;
  for (const robot_stop_t& stop : dut.inForce(99)) {
    stopped.insert(stopped.end(), stop.robot_ids.begin(), stop.robot_ids.end());
  }
  EXPECT_THAT(stopped, SizeIs(250));
  EXPECT_FALSE(dut.refused());
}

}  // namespace
}  // namespace lab::runner::stop_latch_test
