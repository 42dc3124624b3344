#include "analyzer/report/record/step_delays.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::report {
namespace {

TEST(StepDelays, TakesPercentilesByNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);

  const Percentiles dut = percentilesOf(values);

  EXPECT_EQ(dut.count, 100U);
  EXPECT_DOUBLE_EQ(dut.p50, 50);
  EXPECT_DOUBLE_EQ(dut.p95, 95);
  EXPECT_DOUBLE_EQ(dut.p99, 99);
  EXPECT_DOUBLE_EQ(dut.max, 100);
  EXPECT_DOUBLE_EQ(percentilesOf({7}).p50, 7);
  EXPECT_TRUE(std::isnan(percentilesOf({}).p50));
}

TEST(StepDelays, OmitsEventsThatDidNotHappen) {
  StepRecord shown;
  shown.commanded_utime = 1'000'000;
  shown.presented_utime = 1'017'000;
  shown.seen_utime = 1'025'000;
  shown.first_acted_utime = 1'040'000;
  shown.last_acted_utime = 1'060'000;
  shown.robots_acted = 2;
  shown.robots_expected = 3;
  StepRecord lost;
  lost.commanded_utime = 2'000'000;

  EXPECT_EQ(presentedDelays({shown, lost}).count, 1U);
  EXPECT_DOUBLE_EQ(presentedDelays({shown, lost}).max, 17);
  EXPECT_EQ(seenDelays({shown, lost}).count, 1U);
  EXPECT_DOUBLE_EQ(seenDelays({shown, lost}).max, 25);
  EXPECT_DOUBLE_EQ(firstActedDelays({shown, lost}).max, 40);
  // One robot never acted, so there is no last one.
  EXPECT_EQ(lastActedDelays({shown, lost}).count, 0U);
  shown.robots_acted = 3;
  EXPECT_DOUBLE_EQ(lastActedDelays({shown, lost}).max, 60);
}

}  // namespace
}  // namespace lab::report
