// Holds of a few frames, observed by a camera that keeps step with them.
#include "analyzer/curves/frame_phases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/analyzer/program_films.hpp"

namespace lab::analysis::frame_phases_test {
namespace {

ProgramLaw abpWithHold(const std::string& hold) {
  return lawOf(shippedProgram("abp", {{"v", "5 cm/s"}, {"epsilon", hold}, {"eta", "4 rad/s"}}),
               0.075);
}

double errorOf(const FramePhases& phases, bool angular, double frames) {
  return errorsOf({phases.of(angular, frames)}).front();
}

// With frames at phases f and f + 1 of two, a window of one frame turns by 1 - f + f^2 on average,
// in units of the square of what it turns within a hold.
// Eight phases have a variance that is 7 % larger.
TEST(FramePhases, DeviateByTheVarianceOfTheParabola) {
  const FramePhases phases(abpWithHold("0.1 s"), 0.05, 10, 1);

  const double within = 16.0 / 3 * 0.05 * 0.05;
  EXPECT_NEAR(errorOf(phases, true, 1), within * std::sqrt(1.0 / 180), 0.1 * within * 0.0745);
  EXPECT_EQ(errorOf(phases, false, 1), 0);  // the speed is constant
}

TEST(FramePhases, FadeWithTheTimeAndTheNumberOfRobots) {
  const ProgramLaw law = abpWithHold("0.1 s");

  const double hour = errorOf(FramePhases(law, 0.05, 3600, 1), true, 1);
  EXPECT_NEAR(errorOf(FramePhases(law, 0.05, 36000, 1), true, 1), hour / 10, 1e-3 * hour);
  EXPECT_NEAR(errorOf(FramePhases(law, 0.05, 4 * 3600, 4), true, 1), hour / 2, 1e-3 * hour);
}

TEST(FramePhases, DoNotMatterWhereFramesLieAtManyPhases) {
  EXPECT_TRUE(FramePhases(abpWithHold("0.1 s"), 0.0503, 300, 1).matter());
  EXPECT_FALSE(FramePhases(abpWithHold("1 s"), 0.05, 300, 1).matter());
  EXPECT_FALSE(FramePhases(lawOf(shippedProgram("rtp", {}), 0.075), 0.05, 300, 1).matter());
}

// Without the errors of the phases, each of these is called deviating.
TEST(FramePhases, AFaithfulRobotInStepWithTheCameraAgrees) {
  const std::vector<language::NamedText> changes{
      {"v", "5 cm/s"}, {"epsilon", "0.1 s"}, {"eta", "4 rad/s"}};
  FilmOptions options;
  options.duration = 300;
  options.clock_error = 0;
  const ProgramLaw law = lawOf(shippedProgram("abp", changes), bodyFor(options));
  for (const int seed : {1, 6, 9}) {
    const BlockData film =
        filmOf(withoutLaw("abp", changes), law, static_cast<std::uint64_t>(seed), options);
    EXPECT_EQ(judgeFilm(law, film).verdict.kind, VerdictKind::kAgrees) << seed;
  }
}

// An hour resolves 0.1 % of the hold; the clocks of robots are worse.
TEST(FitWithClockErrors, AWrongClockIsNoMisfit) {
  const std::vector<language::NamedText> wrong{{"epsilon", "0.505 s"}};
  FilmOptions options;
  options.clock_error = 0;
  const ProgramLaw law = lawOf(shippedProgram("abp", {}), bodyFor(options));

  const ProgramResult result = judgeFilm(law, filmOf(withoutLaw("abp", wrong), law, 3, options));

  ASSERT_TRUE(result.fit && result.fit->fitted());
  EXPECT_GT(result.fit->p_value, 0.001);
  EXPECT_EQ(result.verdict.kind, VerdictKind::kAgrees);
}

}  // namespace
}  // namespace lab::analysis::frame_phases_test
