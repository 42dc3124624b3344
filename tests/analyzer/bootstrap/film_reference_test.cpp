#include "analyzer/bootstrap/film_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analyzer/program_films.hpp"

namespace lab::analysis {
namespace {

FilmPlan planWithCuts() {
  FilmOptions options;
  FilmPlan plan;
  plan.law = lawOf(withoutLaw("run_reverse"), bodyFor(options));
  plan.frame_period = 0.1;
  plan.lags = {1, 2, 4, 8, 16, 32, 64, 128, 250, 880};
  plan.gaps.cut = true;
  // Segments of 30 s, and a single one that is a little longer than the last lag.
  for (int i = 0; i < 100; ++i) plan.gaps.segments.add(300);
  plan.gaps.segments.add(900);
  setFilms(plan, 1200);
  plan.films = 60;
  return plan;
}

TEST(FilmReference, ALagWithoutWindowsCostsOnlyItself) {
  FilmReference dut(planWithCuts());
  dut.finish();
  EXPECT_EQ(dut.curves().recordings, 60);
  for (std::size_t lag = 0; lag + 1 < dut.curves().lags.size(); ++lag) {
    EXPECT_TRUE(std::isfinite(dut.expected(false, lag))) << lag;
    EXPECT_GT(dut.expected(false, lag), 0);
  }
  EXPECT_TRUE(std::isnan(dut.expected(false, dut.curves().lags.size() - 1)));
}

TEST(FilmReference, FramesThatAreFarApartDoNotCostAllDrawsBetweenThem) {
  FilmPlan plan = planWithCuts();
  plan.gaps = {};
  plan.frame_period = 1e6;
  setFilms(plan, 6e7);
  EXPECT_EQ(plan.duration, 6e7);
  const FilmReference dut(plan);
  EXPECT_LE(dut.plan().films * dut.plan().duration / plan.law->drawTime(), 1.001e8);
  EXPECT_TRUE(dut.curves().lags.empty());

  const FilmPlan usual = planWithCuts();
  EXPECT_EQ(FilmReference(usual).plan().duration, usual.duration);
}

TEST(FilmReference, CutsDoNotChangeTheExpectedCurve) {
  FilmPlan plan = planWithCuts();
  FilmReference cut(plan);
  cut.finish();
  plan.gaps = {};
  FilmReference whole(plan);
  whole.finish();
  for (std::size_t lag = 0; lag < 6; ++lag) {  // up to 3.2 s, known to about 1 %
    EXPECT_NEAR(cut.expected(false, lag) / whole.expected(false, lag), 1, 0.05) << lag;
  }
}

}  // namespace
}  // namespace lab::analysis
