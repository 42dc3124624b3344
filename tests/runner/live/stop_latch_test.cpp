#include "runner/live/stop_latch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace lab::runner::stop_latch_test
