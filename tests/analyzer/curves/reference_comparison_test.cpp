#include "analyzer/curves/reference_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/service/analysis.hpp"
#include "tests/analyzer/program_films.hpp"

namespace lab::analysis {
namespace {

const std::vector<language::NamedText> kPaper{
    {"v", "3 cm/s"}, {"epsilon", "0.5 s"}, {"eta", "3 rad/s"}};

std::vector<language::NamedText> paperWith(const std::string& name, const std::string& value) {
  std::vector<language::NamedText> changed = kPaper;
  for (auto& [key, text] : changed) {
    if (key == name) text = value;
  }
  return changed;
}

TEST(SimulatedReference, AgreesWithTheProgramThatRan) {
  const ProgramLaw law = lawOf(withoutLaw("abp", kPaper), bodyFor({}));
  const ProgramResult dut = judgeFilm(law, filmOf(withoutLaw("abp", kPaper), law, 5));
  EXPECT_GT(dut.verdict.judged, 60);
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kAgrees) << dut.verdict.max_z;
  // The reference is the closed form's curve.
  const ExactLaw exact(lawOf(shippedProgram("abp", kPaper), kPaperWheelBase));
  for (const CurvePoint& point : dut.curves.msd) {
    if (!point.judged) continue;
    EXPECT_NEAR(point.exact / exact.msd(point.tau), 1, 0.03) << point.tau;
  }
}

// Not a hold: a wrong epsilon of 5 % changes the curves by three standard errors of an hour at
// most.
TEST(SimulatedReference, FindsASpeedOrTurningRateFivePercentWrongInAnHour) {
  const ProgramLaw law = lawOf(withoutLaw("abp", kPaper), bodyFor({}));
  for (const auto& [name, value] :
       std::vector<language::NamedText>{{"v", "3.15 cm/s"}, {"eta", "3.15 rad/s"}}) {
    const Program wrong = withoutLaw("abp", paperWith(name, value));
    const ProgramResult dut = judgeFilm(law, filmOf(wrong, law, 7));
    EXPECT_EQ(dut.verdict.kind, VerdictKind::kDisagrees) << name << " " << dut.verdict.max_z;
  }
}

TEST(SimulatedReference, JudgesThePoolAndEachRobot) {
  FilmOptions options;
  options.duration = 900;
  const Program program = withoutLaw("resetting");
  const ProgramLaw law = lawOf(program, bodyFor(options));
  std::vector<BlockData> films;
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    films.push_back(filmOf(program, law, seed, options));
  }
  BlockData pooled;
  std::vector<ProgramResult> robots;
  std::vector<const BlockData*> data;
  for (const BlockData& film : films) {
    pooled.pool(film);
    robots.push_back(analyse(law, film, {}, {}, Depth::kFull));
    data.push_back(&film);
  }
  ProgramResult pool = analyse(law, pooled, {}, {}, Depth::kFull);
  addBootstrapResults(pool, pooled, robots, data, {});
  EXPECT_EQ(pool.verdict.kind, VerdictKind::kAgrees) << pool.verdict.max_z;
  for (const ProgramResult& robot : robots) {
    EXPECT_EQ(robot.verdict.kind, VerdictKind::kAgrees) << robot.verdict.max_z;
    // Three robots are measured more precisely than one.
    EXPECT_GT(robot.curves.msd[30].sigma, 1.4 * pool.curves.msd[30].sigma);
  }
}

TEST(SimulatedReference, IsMadeInSlicesForLiveResults) {
  AnalysisConfig config;
  config.frame_period = 0.05;
  config.max_lag = 20;
  Analysis dut(config);
  const ProgramLaw law = lawOf(withoutLaw("run_reverse"), kPaperWheelBase);
  RecordingPoses poses;
  simulateRecording({law, 600, 0.05, 0, 0, 0}, 3, poses);
  for (std::size_t i = 0; i < poses.x.size(); ++i) {
    const double time = 0.05 * static_cast<double>(i);
    RobotTelemetry telemetry;
    telemetry.time = time;
    telemetry.program_epoch = 1;
    dut.addTelemetry(1, law, telemetry);
    dut.addFrame(
        {time,
         static_cast<std::int64_t>(i),
         {{1, poses.x[i], poses.y[i], std::remainder(poses.theta[i], 6.283185307179586)}}});
  }
  dut.flush();
  int calls = 0;
  while (!dut.results().front().no_verdict.empty() && calls < 40) {
    const ProgramResult before = dut.results().front();
    EXPECT_EQ(before.no_verdict, "The reference is being simulated.");
    EXPECT_EQ(before.verdict.judged, 0);
    dut.simulateReferences();
    ++calls;
  }
  EXPECT_GT(calls, 5);
  EXPECT_LT(calls, 40);
  const ProgramResult after = dut.results().front();
  EXPECT_GT(after.verdict.judged, 10);
  EXPECT_EQ(after.verdict.kind, VerdictKind::kAgrees) << after.verdict.max_z;
}

}  // namespace
}  // namespace lab::analysis
