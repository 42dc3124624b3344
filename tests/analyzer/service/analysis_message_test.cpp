#include "analyzer/service/analysis_message.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/service/analysis.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/message_values.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/walker.hpp"

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

/// The messages about one robot that was seen for some seconds.
std::vector<analysis_t> analysesOf(const ProgramLaw& law, double duration) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = duration;
  AnalysisConfig settings;
  settings.frame_period = 1 / recording.fps;
  settings.max_lag = 20;
  Analysis analysis(settings);
  Walker walker(recording);
  walker.on_frame = [&](const TrackPoint& point) {
    analysis.addFrame({point.time, point.frame, {{1, point.x, point.y, point.theta, 0, 0, true}}});
  };
  walker.on_telemetry = [&](const RobotTelemetry& telemetry) {
    analysis.addTelemetry(1, law, telemetry);
  };
  walker.run();
  analysis.flush();
  std::vector<analysis_t> messages;
  for (const ProgramResult& result : analysis.results()) {
    FeedResult of_robot;
    of_robot.result = result;
    messages.push_back(toMessage(of_robot, "law"));
  }
  return messages;
}

/// Little data, and programs whose law or estimates have no finite value.
TEST(AnalysisMessage, HasNoNumberThatReceiversRefuse) {
  int open_intervals = 0;
  int infinite_values = 0;
  int infinite_laws = 0;
  for (const double duration : {0.3, 5.0, 60.0}) {
    for (const ProgramLaw& law :
         {abpLaw(3, 0.5), abpLaw(0, 0.5), abpLaw(1e-9, 0.5), abpLaw(3, 0.5, 0),
          noisyLaw(0, 0.07, 0.2), noisyLaw(0.01, 0, 0.2), rtpLaw(0.01, 0.5), rtpLaw(2, 1.5)}) {
      for (const analysis_t& dut : analysesOf(law, duration)) {
        EXPECT_EQ(impossibleValue(dut), std::nullopt) << law->name() << ", " << duration << " s";
        for (const estimate_t& one : dut.estimates) {
          open_intervals += std::isfinite(one.value) && std::isinf(one.high) ? 1 : 0;
          infinite_values += std::isinf(one.value) ? 1 : 0;
          infinite_laws += std::isinf(one.theory) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(open_intervals, 0);
  EXPECT_GT(infinite_values, 0);
  EXPECT_GT(infinite_laws, 0);
}

TEST(AnalysisMessage, AnInfiniteErrorIsNotKnown) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  FeedResult result = resultWith(5, 10);
  result.result.estimates[2].sigma = kInfinity;
  result.result.curves.msd[1].sigma = kInfinity;
  result.result.curves.msd[2].paper = kInfinity;
  result.result.curves.msd[3].exact = kInfinity;

  const analysis_t dut = toMessage(result, "rtp");

  EXPECT_TRUE(std::isnan(dut.estimates[2].sigma));
  EXPECT_TRUE(std::isnan(dut.curves[0].sigma[1]));
  EXPECT_TRUE(std::isnan(dut.curves[0].paper[2]));
  EXPECT_TRUE(std::isnan(dut.curves[0].exact[3]));
  EXPECT_EQ(impossibleValue(dut), std::nullopt);
}

}  // namespace
}  // namespace lab::analysis
