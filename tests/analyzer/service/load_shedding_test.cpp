#include "analyzer/service/load_shedding.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace lab::analysis::load_shedding_test {
namespace {

constexpr std::int64_t kLongest = LoadShedding::kLongestBacklog_us;

TEST(LoadShedding, ResultsThatCostLittleAreComputedWheneverAsked) {
  LoadShedding dut;
  EXPECT_TRUE(dut.isDue(0, 0));
  EXPECT_FALSE(dut.computed(1'000'000, 1'000'000));
  EXPECT_TRUE(dut.isDue(1'000'000, 0));
  EXPECT_FALSE(dut.computed(2'000'000, 2'250'000));
  EXPECT_FALSE(dut.isDue(2'900'000, 0));
  EXPECT_TRUE(dut.isDue(3'000'000, 0));
}

TEST(LoadShedding, ResultsThatAreWantedRarelyAreNoOverload) {
  LoadShedding dut;
  EXPECT_FALSE(dut.computed(1'000'000, 1'000'000, 10'000'000));
  EXPECT_FALSE(dut.computed(11'000'000, 11'000'000, 10'000'000));
  EXPECT_EQ(dut.longest(), 1);
  EXPECT_TRUE(dut.computed(26'000'000, 26'000'000, 10'000'000));
  EXPECT_EQ(dut.longest(), 6);
}

TEST(LoadShedding, ExpensiveResultsTakeAQuarterOfTheTime) {
  LoadShedding dut;
  EXPECT_TRUE(dut.computed(1'000'000, 3'000'000));
  EXPECT_EQ(dut.longest(), 8);
  EXPECT_FALSE(dut.isDue(8'999'999, 0));
  EXPECT_TRUE(dut.isDue(9'000'000, 0));
}

TEST(LoadShedding, PausesAtMostHalfAMinute) {
  LoadShedding dut;
  EXPECT_TRUE(dut.computed(1'000'000, 25'000'000));
  EXPECT_EQ(dut.longest(), 54);
  EXPECT_FALSE(dut.isDue(54'999'999, 0));
  EXPECT_TRUE(dut.isDue(55'000'000, 0));
}

TEST(LoadShedding, SaysThatResultsTakeLongBeforeTheyAreComputed) {
  LoadShedding dut;
  EXPECT_FALSE(dut.computed(2'000'000, 2'010'000));
  EXPECT_TRUE(dut.computed(3'000'000, 4'000'000));
  EXPECT_EQ(dut.longest(), 4);
  EXPECT_FALSE(dut.computed(3'000'000, 4'700'000));
  EXPECT_TRUE(dut.computed(3'000'000, 5'000'000));
  EXPECT_EQ(dut.longest(), 8);
}

TEST(LoadShedding, SaysWhenResultsBecomeTwiceAsRare) {
  LoadShedding dut;
  EXPECT_TRUE(dut.computed(1'000'000, 1'500'000));
  EXPECT_EQ(dut.longest(), 2);
  EXPECT_FALSE(dut.computed(4'000'000, 4'700'000)) << "3 s";
  EXPECT_TRUE(dut.computed(7'000'000, 8'000'000));
  EXPECT_EQ(dut.longest(), 4);
  EXPECT_FALSE(dut.computed(11'000'000, 12'000'000));
}

TEST(LoadShedding, ResultsWaitWhileMessagesWait) {
  LoadShedding dut;
  EXPECT_FALSE(dut.computed(1'000'000, 1'010'000));
  EXPECT_TRUE(dut.isDue(2'000'000, LoadShedding::kNoBacklog_us));
  EXPECT_FALSE(dut.isDue(2'000'000, LoadShedding::kNoBacklog_us + 1));
  EXPECT_TRUE(dut.computed(5'900'000, 5'910'000));
  EXPECT_EQ(dut.longest(), 4) << "cheap, but late";
}

TEST(LoadShedding, ResultsGoBeforeFrames) {
  LoadShedding dut;
  for (std::int64_t backlog = 0; backlog <= kLongest; backlog += 100'000) {
    EXPECT_TRUE(dut.takesFrame(backlog)) << backlog;
  }
  EXPECT_FALSE(dut.isDue(0, kLongest));
  EXPECT_EQ(dut.leftOut(), 0);
}

TEST(LoadShedding, FramesAreLeftOutInOnePieceUntilTheBacklogIsGone) {
  LoadShedding dut;
  EXPECT_FALSE(dut.takesFrame(kLongest + 1));
  EXPECT_FALSE(dut.takesFrame(kLongest));
  EXPECT_FALSE(dut.takesFrame(LoadShedding::kNoBacklog_us + 1));
  EXPECT_TRUE(dut.takesFrame(LoadShedding::kNoBacklog_us));
  EXPECT_TRUE(dut.takesFrame(kLongest));
  EXPECT_EQ(dut.frames(), 5);
  EXPECT_EQ(dut.leftOut(), 3);
}

// What piled up while results were computed is analyzed before the next results.
TEST(LoadShedding, WhatWaitedForResultsIsNotLeftOut) {
  LoadShedding dut;
  EXPECT_TRUE(dut.computed(1'000'000, 9'000'000));
  EXPECT_TRUE(dut.takesFrame(8'000'000));
  EXPECT_TRUE(dut.takesFrame(8'000'000 + kLongest));
  EXPECT_FALSE(dut.takesFrame(8'000'001 + kLongest));
}

TEST(LoadShedding, SaysAtTheFirstFrameAndWhenTheirNumberHasDoubled) {
  LoadShedding dut;
  EXPECT_FALSE(dut.hasLeftOutMore());
  std::vector<std::int64_t> said;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(dut.takesFrame(kLongest + 1));
    if (dut.hasLeftOutMore()) said.push_back(dut.leftOut());
  }
  EXPECT_EQ(said, (std::vector<std::int64_t>{1, 2, 4, 8, 16, 32, 64}));
}

}  // namespace
}  // namespace lab::analysis::load_shedding_test
