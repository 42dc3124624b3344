// The rate of false alarms of verdicts by simulated references.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "analyzer/curves/reference_comparison.hpp"
#include "tests/analyzer/program_films.hpp"

namespace lab::analysis {
namespace {

class FalseAlarms : public testing::TestWithParam<std::string> {};

// Each reference judges many films, which are independent of it.
TEST_P(FalseAlarms, AreAtMostOnePercent) {
  constexpr int kFilms = 1000;
  constexpr int kReferences = 5;
  const Program program = withoutLaw(GetParam());
  FilmOptions options;
  options.duration = 900;
  const ProgramLaw law = lawOf(program, bodyFor(options));
  int alarms = 0;
  int judged = 0;
  for (int r = 0; r < kReferences; ++r) {
    FilmPlan plan;
    plan.law = law;
    plan.frame_period = 1 / options.fps;
    plan.sigma = options.sigma;
    plan.sigma_theta = options.sigma_theta;
    plan.seed = 1'000'000 + 1000 * static_cast<std::uint64_t>(r);
    plan.lags = filmOf(program, law, 1, options).lags;
    setFilms(plan, options.duration);
    FilmReference films(plan);
    films.finish();
    for (int i = 0; i < kFilms / kReferences; ++i) {
      const auto seed = static_cast<std::uint64_t>(r * kFilms + i + 1);
      const BlockData data = filmOf(program, law, seed, options);
      Curves measured = curves(law, data, {});
      compareWithFilms(measured, films, law, data, {});
      const Verdict verdict = judge(measured);
      judged += verdict.kind != VerdictKind::kUndecided ? 1 : 0;
      alarms += verdict.kind == VerdictKind::kDisagrees ? 1 : 0;
    }
  }
  EXPECT_EQ(judged, kFilms);
  EXPECT_LE(alarms, kFilms / 100);
  RecordProperty("alarms", alarms);
}

INSTANTIATE_TEST_SUITE_P(Programs, FalseAlarms,
                         testing::Values("abp", "run_reverse", "levy", "chiral_abp", "resetting"),
                         [](const auto& one) { return one.param; });

}  // namespace
}  // namespace lab::analysis
