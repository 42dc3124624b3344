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
  const char* program;
  const char* law;  ///< "closed", "formula", "simulated"
  double fps;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class ShortHolds : public testing::TestWithParam<Case> {};

std::vector<language::NamedText> shortHolds(const std::string& program) {
  if (program == "abp") return {{"v", "5 cm/s"}, {"epsilon", "0.1 s"}, {"eta", "4 rad/s"}};
  return {{"epsilon", "0.1 s"}};
}

/// The same motion, judged in three ways.
Program asked(const Case& one) {
  const std::string law = one.law;
  if (law == "closed") return shippedProgram(one.program, shortHolds(one.program));
  Program program = withoutLaw(one.program, shortHolds(one.program));
  if (law == "formula") {
    program.law.angular_msd =
        "if(tau < epsilon, eta*eta/3*tau*tau*(1 - tau/(3*epsilon)), "
        "epsilon*eta*eta/3*(tau - epsilon/3))";
  }
  return program;
}

/// The verdicts of reports of one robot each, which share what is simulated.
std::vector<Verdict> verdictsOf(const ProgramLaw& law, const std::vector<BlockData>& films) {
  std::vector<Verdict> verdicts;
  BlockData pooled;
  std::vector<ProgramResult> robots;
  std::vector<const BlockData*> data;
  for (const BlockData& film : films) {
    pooled.pool(film);
    robots.push_back(analyse(law, film, {}, {}, Depth::kFull));
    data.push_back(&film);
  }
  const BlockData& pool_data = law->isSimulated() ? films.front() : pooled;
  ProgramResult pool = analyse(law, pool_data, {}, {}, Depth::kFull);
  addBootstrapResults(pool, pool_data, robots, data, {});
  for (const ProgramResult& robot : robots) verdicts.push_back(robot.verdict);
  return verdicts;
}

TEST_P(ShortHolds, RaiseAtMostOneFalseAlarmInAHundred) {
  constexpr int kFilms = 300;
  FilmOptions options;
  options.duration = 300;
  options.fps = GetParam().fps;
  options.sigma_theta = 0.02;
  const Program truth = withoutLaw(GetParam().program, shortHolds(GetParam().program));
  const ProgramLaw law = lawOf(asked(GetParam()), bodyFor(options));
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

INSTANTIATE_TEST_SUITE_P(
    All, ShortHolds,
    testing::Values(Case{"ClosedTwoFrames", "abp", "closed", 20},
                    Case{"ClosedThreeFrames", "abp", "closed", 30},
                    Case{"WheelsTwoFrames", "noisy_abp", "closed", 20},
                    Case{"FormulaTwoFrames", "abp", "formula", 20},
                    Case{"FormulaThreeFrames", "abp", "formula", 30},
                    Case{"SimulatedTwoFrames", "abp", "simulated", 20},
                    Case{"SimulatedThreeFrames", "abp", "simulated", 30},
                    Case{"ChiralTwoFrames", "chiral_abp", "simulated", 20},
                    Case{"ChiralThreeFrames", "chiral_abp", "simulated", 30},
                    Case{"RunReverseTwoFrames", "run_reverse", "simulated", 20},
                    Case{"RunReverseThreeFrames", "run_reverse", "simulated", 30}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace lab::analysis::short_hold_ensemble_test
