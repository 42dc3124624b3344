#include "runner/campaign/live/live_plan.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <string>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::int64_t kHour_us = 3'600'000'000;

TEST(LivePlan, ReadsKnownRules) {
  EXPECT_EQ(parseKnownRule("D_r_rad2_s=2%"), (KnownRule{"D_r_rad2_s", 0.02}));
  EXPECT_EQ(parseKnownRule("abp.v_cm_s=0.5%"), (KnownRule{"abp.v_cm_s", 0.005}));
  for (const char* wrong : {"", "D_r", "=2%", "D_r=2", "D_r=-2%", "D_r=0%", "D_r=x%", "D_r=nan%"}) {
    EXPECT_THROW(static_cast<void>(parseKnownRule(wrong)), UserError) << wrong;
  }
  EXPECT_EQ(parseKnownRule(knownRuleText({"D_r_rad2_s", 0.025})), (KnownRule{"D_r_rad2_s", 0.025}));
}

TEST(LivePlan, ReadsATimeOfTheDayAsTheNextOne) {
  setenv("TZ", "UTC", 1);
  tzset();
  const std::int64_t noon = 1'769'860'800'000'000;  // 2026-01-31T12:00:00Z
  EXPECT_EQ(parseUntil("13:30", noon), noon + 3 * kHour_us / 2);
  EXPECT_EQ(parseUntil("07:00", noon), noon + 19 * kHour_us);
  EXPECT_EQ(parseUntil("12:00", noon), noon + 24 * kHour_us);
  EXPECT_EQ(parseUntil("2026-02-01T12:00", noon), noon + 24 * kHour_us);
  for (const char* wrong : {"", "7", "25:00", "tomorrow", "2026-02-01", "2026-01-31T11:00"}) {
    EXPECT_THROW(static_cast<void>(parseUntil(wrong, noon)), UserError) << wrong;
  }
}

}  // namespace
}  // namespace lab::runner::campaign
