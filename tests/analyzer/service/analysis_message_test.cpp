#include "analyzer/service/analysis_message.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "common/bus/bus.hpp"

namespace lab::analysis {
namespace {

FeedResult resultWith(int lags, std::size_t note_length) {
  FeedResult result;
  result.program.hash = 42;
  result.result.robot = 12;
  result.result.observed = 77;
  result.result.verdict.kind = VerdictKind::kDisagrees;
  result.result.verdict.max_z = 5.5;
  for (int i = 1; i <= lags; ++i) {
    CurvePoint point;
    point.tau = i;
    point.value = 2.0 * i;
    point.noise = 0.5;
    point.exact = 1.5 * i;
    point.windows = 3e9;
    point.selection_biased = i > 3;
    result.result.curves.msd.push_back(point);
    result.result.curves.angular_msd.push_back(point);
  }
  for (int i = 0; i < 8; ++i) {
    Estimate estimate;
    estimate.name = "D_r";
    estimate.unit = "rad^2/s";
    estimate.value = i;
    estimate.note = std::string(note_length, 'n');
    result.result.estimates.push_back(estimate);
  }
  return result;
}

TEST(AnalysisMessage, HasTheContentOfTheResult) {
  const analysis_t dut = toMessage(resultWith(5, 10), "rtp_slow");

  EXPECT_EQ(dut.robot_id, 12);
  EXPECT_EQ(dut.program.name, "rtp_slow");
  EXPECT_EQ(dut.program.hash, 42);
  EXPECT_EQ(dut.verdict, analysis_t::DISAGREES);
  EXPECT_DOUBLE_EQ(dut.max_z, 5.5);
  ASSERT_EQ(dut.num_curves, 2);
  EXPECT_EQ(dut.curves[1].name, "angular_msd");
  ASSERT_EQ(dut.curves[0].num_lags, 5);
  EXPECT_FLOAT_EQ(dut.curves[0].exact[1], 3.5F);  // the law with the tracker's noise
  EXPECT_EQ(dut.curves[0].biased[2], 0);
  EXPECT_EQ(dut.curves[0].biased[3], 1);
  EXPECT_EQ(dut.curves[0].windows[0], std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(dut.num_estimates, 8);
}

TEST(AnalysisMessage, OmitsLagsThatWereNotObserved) {
  FeedResult result = resultWith(5, 10);
  result.result.curves.msd[1].windows = 0;
  result.result.curves.msd[1].value = std::numeric_limits<double>::quiet_NaN();

  const analysis_t dut = toMessage(result, "rtp");

  ASSERT_EQ(dut.curves[0].num_lags, 4);
  EXPECT_FLOAT_EQ(dut.curves[0].lag[1], 3);
}

TEST(AnalysisMessage, StaysBelowEightKilobytesWithBothEndsOfTheCurve) {
  const analysis_t dut = toMessage(resultWith(300, 5000), "rtp");

  EXPECT_LT(encode(dut).size(), 8000U);
  ASSERT_GE(dut.curves[0].num_lags, 40);
  EXPECT_FLOAT_EQ(dut.curves[0].lag.front(), 1);
  EXPECT_FLOAT_EQ(dut.curves[0].lag.back(), 300);
}

TEST(AnalysisMessage, KeepsAllLagsOfAnOrdinaryCurve) {
  const analysis_t dut = toMessage(resultWith(60, 80), "rtp");

  EXPECT_EQ(dut.curves[0].num_lags, 60);
  EXPECT_EQ(dut.estimates[0].note.size(), 80U);
}

}  // namespace
}  // namespace lab::analysis
