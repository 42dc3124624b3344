#include "analyzer/fits/law_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analyzer/service/bootstrap_results.hpp"
#include "tests/analyzer/fits/fit_ensemble.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis {
namespace {

/// Expects 95 % within the binomial 3-sigma band.
void expectFitCoverage(const FitScatter& dut, const std::string& name) {
  const double band = 3 * std::sqrt(0.95 * 0.05 / dut.recordings);
  EXPECT_GT(dut.share(name), 0.95 - band) << name;
  EXPECT_LT(dut.share(name), 0.95 + band) << name;
}

/// Expects that fits and tests confirm the law of the recordings.
/// @param most largest number of recordings with p < 0.01
void expectOwnLaw(const FitScatter& dut, int most) {
  EXPECT_EQ(dut.refused, 0);
  EXPECT_LE(dut.unlikely, most);
  EXPECT_LE(dut.exact_rejected, most);
  EXPECT_LT(std::abs(dut.numbers.at("D_r").relative.z(0)), 4);
  expectFitCoverage(dut, "D_r");
}

TEST(LawFit, ReachesTheLimitOfTheDrawsForTheAbp) {
  const FitScatter dut = fitRecordings(fitRecording(abpLaw(3, 0.5), 600), 200, 10, false, true);
  EXPECT_EQ(dut.refused, 0);
  for (const char* name : {"D_r", "D", "L_s"}) expectFitCoverage(dut, name);
  EXPECT_LT(std::abs(dut.numbers.at("D_r").relative.z(0)), 4);
  EXPECT_LT(std::abs(dut.numbers.at("v").relative.z(0)), 4);
  const double limit = std::sqrt(0.8 * 0.5 / 600);
  EXPECT_LT(dut.sd("D_r"), limit * 1.1 * (1 + 2 / std::sqrt(400.0)));
  EXPECT_LE(dut.guarded, 2);  // ten minutes: the long lags behind ordinary least squares are skewed
  EXPECT_LE(dut.unlikely, 8);
  EXPECT_LE(dut.exact_rejected, 8);
  EXPECT_EQ(dut.paper_rejected, 200);  // eq. 4 is 8 % off at 1.4 s
}

TEST(LawFit, RefusesShortRecordingsByTheExpectedNumberOfTumbles) {
  MeasuredCurves curves;
  curves.observed = 90;  // s; a run takes 1 s on average, a tumble 0.5 s
  EXPECT_EQ(
      fitLaw(rtpLaw(1, 0.5), curves, {}).refusal,
      "about 60 tumbles are expected in the free motion observed, by the program; a fit needs "
      "100: record for longer");
}

TEST(LawFit, HoldsForTheBp) {
  WalkerRecording recording = fitRecording(noisyLaw(0, 0.07, 0.2), 300);
  recording.fps = 19.97;
  const FitScatter dut = fitRecordings(recording, 100, 5, false, true);
  EXPECT_EQ(dut.refused, 0);
  expectFitCoverage(dut, "V");
  EXPECT_LT(std::abs(dut.numbers.at("V").relative.z(0)), 4);
  EXPECT_LE(dut.exact_rejected, 6);
}

TEST(LawFit, HoldsForTheRtpWhosePaperFormulaIsExact) {
  const FitScatter dut = fitRecordings(fitRecording(rtpLaw(1, 0.5), 600), 100, 20, false, true);
  EXPECT_EQ(dut.refused, 0);
  expectFitCoverage(dut, "gamma");
  EXPECT_LT(std::abs(dut.numbers.at("gamma").relative.z(0)), 4);
  EXPECT_LE(dut.paper_rejected, 6);
}

TEST(LawFit, WorksWithItsOwnCovariance) {
  const FitScatter dut = fitRecordings(fitRecording(abpLaw(3, 0.5), 300), 15, 10, true, false);
  EXPECT_EQ(dut.refused, 0);
  EXPECT_GE(dut.share("D_r"), 0.7);
  EXPECT_NEAR(dut.numbers.at("D_r").sigma.mean(), std::sqrt(0.8 * 0.5 / 300), 0.005);
}

// The covariance of lags depends on the selected windows: simulated recordings must select like the
// accumulator, which skips more windows the more frames a lag has.
TEST(LawFit, HasACalibratedPValueAtEveryFrameRate) {
  for (const double fps : {24.3, 49.9, 121.0, 240.0}) {
    WalkerRecording recording = fitRecording(abpLaw(4, 0.4), 300);
    recording.fps = fps;
    recording.sigma = 0.0003;
    recording.sigma_theta = 0.0105;
    const FitScatter dut = fitRecordings(recording, 30, 5, false, false);
    EXPECT_EQ(dut.refused, 0) << fps;
    EXPECT_LE(dut.unlikely, 3) << fps;  // 0.3 expected; 4 by chance once in 10^4
    EXPECT_LT(std::abs(dut.numbers.at("D_r").relative.z(0)), 4) << fps;
  }
}

// Lost frames remove different windows of each lag, so neighbouring lags are less correlated.
TEST(LawFit, HasACalibratedPValueWithLostFrames) {
  struct Loss {
    double share, length, fps;
  };
  for (const Loss loss : {Loss{0.05, 1.05, 20.3}, {0.2, 3, 20.3}, {0.05, 1.05, 121}}) {
    SCOPED_TRACE(loss.share);
    SCOPED_TRACE(loss.fps);
    WalkerRecording recording = fitRecording(abpLaw(3, 0.47), 300);
    recording.fps = loss.fps;
    recording.sigma = 0.0005;
    recording.sigma_theta = 0.0175;
    recording.missing = loss.share;
    recording.missing_length = loss.length;
    const FitScatter dut = fitRecordings(recording, 40, 5, false, true);
    expectOwnLaw(dut, 4);  // 0.4 expected; 5 by chance once in 10^4
  }
}

// Contacts are cut: few windows of long lags remain, and other ones than of short lags.
TEST(LawFit, HasACalibratedPValueInACrowd) {
  for (const double every : {2.0, 6.0}) {
    SCOPED_TRACE(every);
    WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 400);
    recording.fps = 20.3;
    recording.sigma = 0.0005;
    recording.sigma_theta = 0.0175;
    recording.cut_every = every;
    const FitScatter dut = fitRecordings(recording, 60, 5, false, true);
    expectOwnLaw(dut, 5);  // 0.6 expected; 6 by chance once in 10^4
  }
}

TEST(LawFit, IsReproducibleToTheBit) {
  const WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 120);
  const MeasuredCurves curves = curvesOfRecording(recording, 10);
  const LawFit once = fitLaw(recording.law, curves, {});
  const LawFit again = fitLaw(recording.law, curves, {});
  ASSERT_TRUE(once.fitted()) << once.refusal;
  EXPECT_EQ(once.parameters.front().value, again.parameters.front().value);
  EXPECT_EQ(once.chi2, again.chi2);
}

TEST(LawFit, WorksWithoutHeadings) {
  const WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 600);
  MeasuredCurves curves = curvesOfRecording(recording, 10);
  curves.angular_msd.assign(curves.lags.size(), std::nan(""));
  const LawFit dut = fitLaw(recording.law, curves, {});
  ASSERT_TRUE(dut.fitted()) << dut.refusal;
  EXPECT_FALSE(dut.angular);
  EXPECT_LT(std::abs(dut.derived.front().value - 0.75), 4 * dut.derived.front().sigma);
}

TEST(LawFit, GivesAReasonIfDataAreInsufficient) {
  const ProgramLaw law = abpLaw(3, 0.5);
  EXPECT_NE(fitLaw(law, MeasuredCurves{}, {}).refusal.find("no free motion"), std::string::npos);

  const WalkerRecording shorter = fitRecording(law, 30);
  EXPECT_NE(fitLaw(law, curvesOfRecording(shorter, 10), {}).refusal.find("draws of the noise"),
            std::string::npos);

  const WalkerRecording recording = fitRecording(law, 120);
  MeasuredCurves still = curvesOfRecording(recording, 10);
  const double noise = still.offset;
  for (double& value : still.msd) value = noise;
  EXPECT_NE(fitLaw(law, still, {}).refusal.find("no motion"), std::string::npos);

  MeasuredCurves one = curvesOfRecording(recording, 10);
  for (std::size_t i = 1; i < one.lags.size(); ++i) one.msd[i] = one.angular_msd[i] = std::nan("");
  EXPECT_NE(fitLaw(law, one, {}).refusal.find("lags"), std::string::npos);

  const ProgramLaw other = law.withSpeed(0.3);  // ten times what was recorded
  EXPECT_NE(
      fitLaw(other, curvesOfRecording(recording, 10), {}).refusal.find("not like the program's"),
      std::string::npos);
}

TEST(LawFit, RejectsAProgramThatWasNotRun) {
  const WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 600);
  const MeasuredCurves curves = curvesOfRecording(recording, 10);
  const ProgramLaw wrong = abpLaw(3.6, 0.5);
  const LawTest dut =
      testLaw(TestedLaw::kExact, wrong, curves, simulateForTest(wrong, curves, 300, 1), {});
  EXPECT_LT(dut.p_value, 1e-3);
  const LawFit fit = fitLaw(wrong, curves, {});
  ASSERT_TRUE(fit.fitted());
  EXPECT_NEAR(fit.derived.front().value, 0.75, 4 * fit.derived.front().sigma);
}

/// How often the interval of an estimate holds the true value, in recordings of a robot that runs
/// `truth` instead of the programmed law.
int covered(const ProgramLaw& programmed, const ProgramLaw& truth, const std::string& name,
            double value, const std::vector<std::string>& free_times, int recordings) {
  FitOptions options;
  options.free_times = free_times;
  SimulatedCurves simulated;
  int covered = 0;
  for (int i = 0; i < recordings; ++i) {
    WalkerRecording recording = fitRecording(truth, 600);
    recording.fps = 19.97;
    recording.seed = 70000U + static_cast<unsigned>(i);
    ProgramAnalysis analysis(programmed, 1 / recording.fps, 10);
    for (const Sample& sample : stitch(recording).samples) analysis.add(sample);
    const MeasuredCurves curves = measuredCurves(programmed, analysis.data());
    if (i == 0) {
      simulated = simulateForFit(truth, curves.offset, curves.angular_offset, curves,
                                 planFit(programmed, curves, options), options);
    }
    const LawFit fit = fitLaw(programmed, curves, options, &simulated);
    EXPECT_TRUE(fit.fitted()) << fit.refusal;
    for (const auto* estimates : {&fit.parameters, &fit.derived}) {
      for (const Estimate& one : *estimates) {
        if (one.name == name) covered += one.low95 <= value && value <= one.high95 ? 1 : 0;
      }
    }
  }
  return covered;
}

TEST(LawFit, FreesTheTimesThatItIsAskedFor) {
  constexpr int kRecordings = 60;  // 57 are expected; below 50 once in 3000
  const ProgramLaw abp = abpLaw(3, 0.5);
  const ProgramLaw held_longer = abp.with("epsilon", 0.54);
  const double d_r = held_longer->rotationalDiffusivity();
  EXPECT_GE(covered(abp, held_longer, "epsilon", 0.54, {"epsilon"}, kRecordings), 50);
  EXPECT_GE(covered(abp, held_longer, "D_r", d_r, {"epsilon", "tau_t"}, kRecordings), 50);
  EXPECT_LT(covered(abp, held_longer, "D_r", d_r, {}, kRecordings), 40);

  const ProgramLaw rtp = rtpLaw(1, 0.5);
  const ProgramLaw turns_longer = rtp.with("tau_t", 0.6);
  EXPECT_GE(covered(rtp, turns_longer, "tau_t", 0.6, {"tau_t"}, kRecordings), 50);
  EXPECT_GE(covered(rtp, turns_longer, "gamma", 1, {"tau_t"}, kRecordings), 50);
}

TEST(RecordingFit, SimulatedRecordingsOfThePoolServeItsRobots) {
  WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 300);
  std::vector<BlockData> blocks;
  for (int robot = 0; robot < 4; ++robot) {
    recording.seed = 60U + static_cast<unsigned>(robot);
    ProgramAnalysis analysis(recording.law, 1 / recording.fps, 20);
    for (const Sample& sample : stitch(recording).samples) analysis.add(sample);
    blocks.push_back(analysis.data());
  }
  BlockData all;
  std::vector<const BlockData*> data;
  std::vector<ProgramResult> robots;
  for (const BlockData& block : blocks) {
    data.push_back(&block);
    all.pool(block);
    robots.push_back(analyse(recording.law, block, {}, {}));
  }
  ProgramResult pool = analyse(recording.law, all, {}, {});
  addBootstrapResults(pool, all, robots, data, {});
  ASSERT_TRUE(pool.fit && pool.fit->fitted());
  ASSERT_TRUE(pool.fit->exact && pool.fit->paper);
  EXPECT_GT(pool.fit->exact->p_value, 1e-3);
  EXPECT_LT(pool.fit->paper->p_value, 1e-3);
  for (const ProgramResult& robot : robots) {
    ASSERT_TRUE(robot.fit && robot.fit->fitted());
    // A quarter of the time has twice the error.
    EXPECT_NEAR(robot.fit->derived[0].sigma / pool.fit->derived[0].sigma, 2, 0.25);
  }
}

TEST(CurvesWithRecordings, StateTheTrueScatterOfLongLags) {
  WalkerRecording recording = fitRecording(abpLaw(3, 0.5), 300);
  Scatter value;
  Scatter sigma;
  SimulatedCurves recordings;
  for (int i = 0; i < 150; ++i) {
    recording.seed = 300U + static_cast<unsigned>(i);
    ProgramAnalysis analysis(recording.law, 1 / recording.fps, 30);
    for (const Sample& sample : stitch(recording).samples) analysis.add(sample);
    if (i == 0) {
      recordings =
          simulateForTest(recording.law, measuredCurves(recording.law, analysis.data()), 400, 9);
    }
    CurveOptions options;
    options.recordings = &recordings;
    const Curves dut = curves(recording.law, analysis.data(), options);
    const CurvePoint& point = dut.angular_msd[dut.angular_msd.size() - 6];
    EXPECT_GT(point.tau, 10);
    value.add(point.value);
    sigma.add(point.sigma);
  }
  EXPECT_NEAR(sigma.mean() / value.deviation(), 1, 3 / std::sqrt(300.0) + 0.03);
}

}  // namespace
}  // namespace lab::analysis
