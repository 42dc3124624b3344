#include "dds_gateway/ros/light_arbiter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lab::gateway::light_arbiter_test {
namespace {

constexpr std::int64_t kTimeout = 400'000;
constexpr std::int64_t kNow = 1'000'000'000;

TEST(LightArbiter, ShowsAtOnceAndRepeatsUntilItIsReleased) {
  LightArbiter dut(kTimeout);
  EXPECT_FALSE(dut.due(kNow));
  EXPECT_EQ(dut.show(1, 0.5, 0, "x", kNow), Answer::kTaken);
  const auto first = dut.due(kNow);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->priority, light_command_t::MANUAL);
  ASSERT_EQ(first->num_layers, 1);
  EXPECT_EQ(first->layers.at(0).intensity, 0.5);
  EXPECT_EQ(first->release, 0);
  EXPECT_FALSE(dut.due(kNow + 100'000));
  const auto again = dut.due(kNow + 500'000);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->seq, first->seq);
  EXPECT_EQ(dut.release(1, kNow + 600'000), Answer::kTaken);
  int farewells = 0;
  for (int i = 0; i < 20; ++i) {
    const auto last = dut.due(kNow + 600'000 + i * 500'000);
    if (!last) continue;
    ++farewells;
    EXPECT_EQ(last->release, 1);
    EXPECT_GT(last->seq, first->seq);
  }
  EXPECT_EQ(farewells, 3);
}

TEST(LightArbiter, ALongOrBrokenLabelIsCutAndRepaired) {
  LightArbiter dut(kTimeout);
  const std::string endless(5'000'000, 'x');
  EXPECT_EQ(dut.show(1, 0.5, 0, endless, kNow), Answer::kTaken);
  EXPECT_EQ(dut.due(kNow)->label, std::string(100, 'x'));
  EXPECT_EQ(dut.show(1, 0.6, 0, "a\xff", kNow), Answer::kTaken);
  EXPECT_EQ(dut.due(kNow + 500'000)->label, "a\xEF\xBF\xBD");
}

TEST(LightArbiter, HoldsForTheRequestedTime) {
  LightArbiter dut(kTimeout);
  dut.show(1, 0.5, 2, "x", kNow);
  EXPECT_EQ(dut.due(kNow)->release, 0);
  EXPECT_EQ(dut.due(kNow + 1'999'999)->release, 0);
  EXPECT_EQ(dut.due(kNow + 2'500'000)->release, 1);
}

TEST(LightArbiter, RefusesAnInvalidLight) {
  LightArbiter dut(kTimeout);
  EXPECT_EQ(dut.show(1, std::nan(""), 0, "", kNow), Answer::kNotFinite);
  EXPECT_EQ(dut.show(1, 1.01, 0, "", kNow), Answer::kOutOfRange);
  EXPECT_EQ(dut.show(1, -0.01, 0, "", kNow), Answer::kOutOfRange);
  EXPECT_EQ(dut.show(1, 1, -1, "", kNow), Answer::kOutOfRange);
  EXPECT_EQ(dut.show(1, 1, std::numeric_limits<double>::infinity(), "", kNow), Answer::kNotFinite);
  EXPECT_FALSE(dut.due(kNow));
}

TEST(LightArbiter, OnePublisherHoldsIt) {
  LightArbiter dut(kTimeout);
  EXPECT_EQ(dut.show(1, 0.5, 0, "", kNow), Answer::kTaken);
  EXPECT_EQ(dut.show(2, 0.9, 0, "", kNow + kTimeout), Answer::kOwned);
  EXPECT_EQ(dut.release(2, kNow + kTimeout), Answer::kOwned);
  EXPECT_EQ(dut.show(2, 0.9, 0, "", kNow + kTimeout + 1), Answer::kTaken);
  EXPECT_EQ(dut.due(kNow + kTimeout + 1)->layers.at(0).intensity, 0.9);
}

TEST(LightArbiter, TheSameLightAgainIsTheSameCommand) {
  LightArbiter dut(kTimeout);
  dut.show(1, 0.5, 0, "", kNow);
  const auto seq = dut.due(kNow)->seq;
  dut.show(1, 0.5, 0, "", kNow + 100'000);
  EXPECT_FALSE(dut.due(kNow + 100'000));
  EXPECT_EQ(dut.due(kNow + 500'000)->seq, seq);
}

}  // namespace
}  // namespace lab::gateway::light_arbiter_test
