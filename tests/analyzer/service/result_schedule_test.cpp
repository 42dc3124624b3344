#include "analyzer/service/result_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::analysis {
namespace {

constexpr std::int64_t kFirst = 1'600'000'000'000'000;

/// The times of results [ms since the first] in `seconds`, asked 125 times a second.
std::vector<std::int64_t> timesIn(ResultSchedule dut, std::int64_t seconds) {
  std::vector<std::int64_t> times;
  for (std::int64_t now = 0; now < seconds * 1'000'000; now += 8000) {
    if (!dut.isDue(kFirst + now)) continue;
    dut.computed(kFirst + now);
    times.push_back(now / 1000);
  }
  return times;
}

TEST(ResultSchedule, SomebodyWhoWaitsGetsResultsEverySecond) {
  EXPECT_EQ(timesIn(ResultSchedule(), 5), (std::vector<std::int64_t>{0, 1000, 2000, 3000, 4000}));
}

TEST(ResultSchedule, TheLogGetsThemAtATenthOfTheTimeSoFarFromOneToTenSeconds) {
  const std::vector<std::int64_t> times = timesIn(ResultSchedule(0, ResultReaders::kLogOnly), 3600);

  ASSERT_GT(times.size(), 100U);
  EXPECT_LT(times.size(), 400U);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const std::int64_t step = times[i] - times[i - 1];
    EXPECT_GE(step, 1000) << times[i];
    EXPECT_LE(step, 10'000) << times[i];
    EXPECT_LE(step, std::max<std::int64_t>(1000, times[i - 1] / 10 + 8)) << times[i];
  }
}

TEST(ResultSchedule, TheExperimentMayAskForAnotherInterval) {
  EXPECT_EQ(timesIn(ResultSchedule(30), 100),
            (std::vector<std::int64_t>{0, 30'000, 60'000, 90'000}));
  EXPECT_EQ(timesIn(ResultSchedule(2, ResultReaders::kLogOnly), 7),
            (std::vector<std::int64_t>{0, 2000, 4000, 6000}));
}

}  // namespace
}  // namespace lab::analysis
