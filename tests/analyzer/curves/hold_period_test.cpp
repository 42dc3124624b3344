#include "analyzer/curves/hold_period.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/analyzer/program_films.hpp"

namespace lab::analysis::hold_period_test {
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

std::optional<HoldPeriod> measured(const Program& truth, const Program& asked, std::uint64_t seed,
                                   const FilmOptions& options) {
  return holdPeriod(filmOf(truth, lawOf(asked, bodyFor(options)), seed, options).holds);
}

/// Films of ten minutes without errors of the clock: the error that is said contains the scatter
/// and the bias. For bp it is almost only scatter, so there it must not be larger either.
TEST(HoldPeriod, HasAnHonestError) {
  FilmOptions options;
  options.duration = 600;
  options.clock_error = 0;
  // Sixteen groups: Student's t with 15 degrees of freedom, variance 1.15, kurtosis 3.5.
  constexpr int kFilms = 40;
  const double tolerance = 4 * 1.15 * std::sqrt(2.5 / kFilms);
  for (const std::string name : {"abp", "bp", "chiral_abp"}) {
    const Program program = shippedProgram(name, {}, kWidestWheels);
    double sum = 0;
    double squares = 0;
    double bias = 0;
    double scatter = 0;
    for (std::uint64_t seed = 1; seed <= kFilms; ++seed) {
      const auto dut = measured(program, program, seed, options);
      ASSERT_TRUE(dut) << name << " " << seed;
      const double z = (dut->value - dut->programmed) / dut->sigma;
      sum += z;
      squares += z * z;
      const double relative = dut->value / dut->programmed - 1;
      bias += relative / kFilms;
      scatter += relative * relative / kFilms;
      EXPECT_LT(dut->sigma / dut->value, 0.01) << name;
    }
    EXPECT_LT(squares / kFilms, 1.15 + tolerance) << name;
    // What the error contains for the displacement of the line.
    EXPECT_LT(std::abs(bias), 2e-4 + 4 * std::sqrt(scatter / kFilms)) << name;
    if (name == "bp") {
      EXPECT_LT(std::abs(sum / kFilms) * std::sqrt(kFilms), 4);
      EXPECT_GT(squares / kFilms, 1.15 - tolerance);
    }
  }
}

TEST(HoldPeriod, TellsAHoldFivePercentLongerInTenMinutes) {
  FilmOptions options;
  options.duration = 600;
  const Program asked = shippedProgram("abp", kPaper);
  for (const char* hold : {"0.525 s", "0.475 s"}) {
    const auto dut = measured(shippedProgram("abp", paperWith("epsilon", hold)), asked, 3, options);
    ASSERT_TRUE(dut);
    EXPECT_GT(std::abs(dut->z), 5) << hold;
  }
}

TEST(HoldPeriod, SurvivesLostFramesCutsAndNoise) {
  FilmOptions options;
  options.duration = 600;
  options.sigma_theta = 0.03;
  const Program program = shippedProgram("abp", kPaper);
  const ProgramLaw law = lawOf(program, bodyFor(options));
  RecordingPoses poses;
  simulateRecording({law, options.duration, 0.05, 0, options.sigma_theta, 0}, 4, poses);
  ProgramAnalysis analysis(law, 0.05, 100);
  for (std::size_t i = 0; i < poses.x.size(); ++i) {
    if (i % 37 == 0) continue;  // lost
    Sample sample;
    sample.time = sample.free_time = static_cast<double>(i) * 0.05;
    sample.frame = static_cast<std::int64_t>(i);
    sample.x = poses.x[i];
    sample.y = poses.y[i];
    sample.theta = poses.theta[i];
    // A contact every 25 seconds.
    sample.segment = sample.angular_segment = sample.piece = static_cast<int>(i / 500);
    analysis.add(sample);
  }
  const auto dut = holdPeriod(analysis.data().holds);
  ASSERT_TRUE(dut);
  EXPECT_LT(std::abs(dut->value - 0.5) / dut->sigma, 4);
  EXPECT_LT(dut->sigma, 0.005);
}

TEST(HoldPeriod, IsNotMeasuredWithoutALine) {
  FilmOptions options;
  options.duration = 600;
  // It turns at a constant rate, so nothing changes but noise.
  const Program abp = shippedProgram("abp", kPaper);
  EXPECT_FALSE(measured(shippedProgram("abp", paperWith("eta", "0 rad/s")), abp, 1, options));
  // Runs end at random times.
  EXPECT_FALSE(measured(shippedProgram("rtp"), abp, 1, options));
  EXPECT_EQ(lawOf(shippedProgram("rtp"), kPaperWheelBase)->steadyHold(), 0);
  EXPECT_EQ(lawOf(withoutLaw("run_reverse"), kPaperWheelBase)->steadyHold(), 0.1);
  // Two frames a hold.
  EXPECT_FALSE(HoldPeriodFinder::resolves(0.1, 0.05));
  EXPECT_TRUE(HoldPeriodFinder::resolves(0.5, 0.05));
  // An hour at 10 000 frames/s: 24 million headings for each robot.
  EXPECT_FALSE(HoldPeriodFinder::resolves(3600, 1e-4));
  EXPECT_FALSE(HoldPeriodFinder::resolves(std::numeric_limits<double>::infinity(), 0.05));
}

TEST(HoldPeriod, DecidesTheVerdict) {
  const Program truth = shippedProgram("abp", paperWith("epsilon", "0.525 s"));
  for (const Program& asked : {shippedProgram("abp", kPaper), withoutLaw("abp", kPaper)}) {
    const ProgramLaw law = lawOf(asked, bodyFor({}));
    const ProgramResult dut = judgeFilm(law, filmOf(truth, law, 7));
    EXPECT_EQ(dut.verdict.kind, VerdictKind::kDisagrees);
    EXPECT_TRUE(dut.verdict.hold);
    EXPECT_NEAR(dut.verdict.tau, 0.525, 0.01);
    EXPECT_EQ(dut.estimates.back().name, "epsilon");
  }
}

}  // namespace
}  // namespace lab::analysis::hold_period_test
