// The rate of false alarms of verdicts where a hold lasts two or three frames, so that the noise of
// the heading and the motion within a hold are seen at the same few lags.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "tests/analyzer/program_films.hpp"

namespace lab::analysis::short_hold_ensemble_test {
namespace {

struct Case {
  const char* name;
  const char* law;  ///< "closed", "formula", "simulated"
  double fps;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class ShortHolds : public testing::TestWithParam<Case> {};

const std::vector<language::NamedText> kShort{
    {"v", "5 cm/s"}, {"epsilon", "0.1 s"}, {"eta", "4 rad/s"}};

/// The same motion, judged in three ways.
Program asked(const std::string& law) {
  if (law == "closed") return shippedProgram("abp", kShort);
  Program program = withoutLaw("abp", kShort);
  if (law == "formula") {
    program.law.angular_msd =
        "if(tau < epsilon, eta*eta/3*tau*tau*(1 - tau/(3*epsilon)), "
        "epsilon*eta*eta/3*(tau - epsilon/3))";
  }
  return program;
}

TEST_P(ShortHolds, RaiseAtMostOneFalseAlarmInAHundred) {
  constexpr int kFilms = 200;
  FilmOptions options;
  options.duration = 300;
  options.fps = GetParam().fps;
  options.sigma_theta = 0.02;
  const Program truth = withoutLaw("abp", kShort);
  const ProgramLaw law = lawOf(asked(GetParam().law), bodyFor(options));
  int alarms = 0;
  int judged = 0;
  for (int film = 0; film < kFilms; ++film) {
    const BlockData data = filmOf(truth, law, static_cast<std::uint64_t>(film) + 1, options);
    const Verdict verdict = judgeFilm(law, data).verdict;
    judged += verdict.kind != VerdictKind::kUndecided ? 1 : 0;
    if (verdict.kind != VerdictKind::kDisagrees) continue;
    ++alarms;
    std::printf("film %d: %.1f at %.3f s of the %s\n", film, verdict.max_z, verdict.tau,
                verdict.angular ? "angular MSD" : "MSD");
  }
  EXPECT_EQ(judged, kFilms);
  EXPECT_LE(alarms, kFilms / 100);
  RecordProperty("alarms", alarms);
}

INSTANTIATE_TEST_SUITE_P(All, ShortHolds,
                         testing::Values(Case{"ClosedTwoFrames", "closed", 20},
                                         Case{"ClosedThreeFrames", "closed", 30},
                                         Case{"FormulaTwoFrames", "formula", 20},
                                         Case{"FormulaThreeFrames", "formula", 30},
                                         Case{"SimulatedTwoFrames", "simulated", 20},
                                         Case{"SimulatedThreeFrames", "simulated", 30}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace lab::analysis::short_hold_ensemble_test
