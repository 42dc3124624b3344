// The rate of false alarms of verdicts where a hold lasts two or three frames, so that the noise of
// the heading and the motion within a hold are seen at the same few lags.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

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

/// The verdicts of reports of one robot each. Where only the errors of long lags are simulated, all
/// share these simulations.
std::vector<Verdict> verdictsOf(const ProgramLaw& law, const std::vector<BlockData>& films) {
  std::vector<Verdict> verdicts;
  if (law->isSimulated()) {
    for (const BlockData& film : films) verdicts.push_back(judgeFilm(law, film).verdict);
    return verdicts;
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
  for (const ProgramResult& robot : robots) verdicts.push_back(robot.verdict);
  return verdicts;
}

TEST_P(ShortHolds, RaiseAtMostOneFalseAlarmInAHundred) {
  constexpr int kFilms = 200;
  FilmOptions options;
  options.duration = 300;
  options.fps = GetParam().fps;
  options.sigma_theta = 0.02;
  const Program truth = withoutLaw("abp", kShort);
  const ProgramLaw law = lawOf(asked(GetParam().law), bodyFor(options));
  std::vector<BlockData> films;
  for (int film = 0; film < kFilms; ++film) {
    films.push_back(filmOf(truth, law, static_cast<std::uint64_t>(film) + 1, options));
  }
  int alarms = 0;
  int judged = 0;
  double largest = 0;
  for (const Verdict& verdict : verdictsOf(law, films)) {
    judged += verdict.kind != VerdictKind::kUndecided ? 1 : 0;
    largest = std::max(largest, verdict.max_z);
    if (verdict.kind != VerdictKind::kDisagrees) continue;
    ++alarms;
    std::printf("false alarm: %.1f at %.3f s of the %s\n", verdict.max_z, verdict.tau,
                verdict.angular ? "angular MSD" : "MSD");
  }
  std::printf("%d false alarms of %d, largest deviation %.1f\n", alarms, kFilms, largest);
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
