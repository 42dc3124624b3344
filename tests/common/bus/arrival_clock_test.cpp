#include "common/bus/arrival_clock.hpp"

#include <gtest/gtest.h>

#include "common/bus/channels.hpp"

namespace lab::arrival_clock_test {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kYear = 31'557'600 * kSecond;

struct Heard {
  bool at(std::int64_t utime, std::int64_t now, const char* sender = "tracker_svc",
          std::int64_t instance = 1) {
    return dut.accepts(sender, instance, utime, now);
  }
  ArrivalClock dut;
};

TEST(ArrivalClock, AcceptsAStreamInItsOwnTime) {
  Heard heard;
  for (std::int64_t i = 0; i < 100; ++i) EXPECT_TRUE(heard.at(i * 20'000, kNow + i * 20'000));
  // A silence of an hour, and a queue that is read late.
  EXPECT_TRUE(heard.at(3600 * kSecond, kNow + 3600 * kSecond));
  for (std::int64_t i = 1; i < 100; ++i) {
    EXPECT_TRUE(heard.at(3600 * kSecond + i * kSecond, kNow + 3700 * kSecond));
  }
}

TEST(ArrivalClock, RefusesASingleMessageOfAnotherYear) {
  Heard heard;
  EXPECT_TRUE(heard.at(kNow, kNow));
  EXPECT_FALSE(heard.at(kNow + 40 * kYear, kNow + 20'000));
  EXPECT_TRUE(heard.at(kNow + 40'000, kNow + 40'000));
  EXPECT_FALSE(heard.at(0, kNow + 60'000));
  EXPECT_TRUE(heard.at(kNow + 80'000, kNow + 80'000));
}

TEST(ArrivalClock, RefusesASingleMessageOfAForgedSender) {
  Heard heard;
  EXPECT_TRUE(heard.at(kNow, kNow));
  for (int forged = 0; forged < 1000; ++forged) {
    EXPECT_FALSE(heard.at(kNow + kYear, kNow, "x", forged)) << forged;
  }
  EXPECT_TRUE(heard.at(kNow + 20'000, kNow + 20'000));
}

// A service that is restarted after a step of the wall clock, beside one that was not.
TEST(ArrivalClock, AcceptsAnotherClockAfterThreeMessages) {
  Heard heard;
  const std::int64_t step = 3600 * kSecond;
  EXPECT_TRUE(heard.at(kNow, kNow, "sim_svc"));
  for (std::int64_t i = 1; i < 50; ++i) {
    const std::int64_t now = kNow + i * 20'000;
    EXPECT_TRUE(heard.at(now, now, "sim_svc"));
    EXPECT_EQ(heard.at(now - step, now, "robot_bridge", 2), i >= ArrivalClock::kAgreeing) << i;
  }
}

TEST(ArrivalClock, LeavesCommandsAndEventsAlone) {
  EXPECT_TRUE(timesFollowClock(channels::kTrackedFrame));
  EXPECT_FALSE(timesFollowClock(channels::kRobotStop));
  EXPECT_FALSE(timesFollowClock(channels::kRobotCommand));
  EXPECT_FALSE(timesFollowClock(channels::kExperimentEvent));
}

}  // namespace
}  // namespace lab::arrival_clock_test
