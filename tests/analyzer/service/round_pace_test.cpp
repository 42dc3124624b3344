#include "analyzer/service/round_pace.hpp"

#include <gtest/gtest.h>

namespace lab::analysis::round_pace_test {
namespace {

TEST(RoundPace, ResultsThatCostLittleAreComputedWheneverAsked) {
  RoundPace dut;
  EXPECT_TRUE(dut.isDue(0));
  EXPECT_FALSE(dut.note(1'000'000, 1'000'000));
  EXPECT_TRUE(dut.isDue(1'000'000));
  EXPECT_FALSE(dut.note(2'000'000, 2'250'000));
  EXPECT_FALSE(dut.isDue(2'900'000));
  EXPECT_TRUE(dut.isDue(3'000'000));
}

TEST(RoundPace, ExpensiveResultsTakeAQuarterOfTheTime) {
  RoundPace dut;
  EXPECT_EQ(dut.note(0, 2'000'000), 8);
  EXPECT_FALSE(dut.isDue(7'999'999));
  EXPECT_TRUE(dut.isDue(8'000'000));
}

TEST(RoundPace, SaysWhenResultsBecomeTwiceAsRare) {
  RoundPace dut;
  EXPECT_EQ(dut.note(0, 500'000), 2);
  EXPECT_FALSE(dut.note(10'000'000, 10'700'000)) << "3 s";
  EXPECT_EQ(dut.note(20'000'000, 21'000'000), 4);
  EXPECT_FALSE(dut.note(30'000'000, 31'000'000));
}

}  // namespace
}  // namespace lab::analysis::round_pace_test
