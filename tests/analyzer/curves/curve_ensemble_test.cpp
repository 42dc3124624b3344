// Ensembles large enough to see small biases and wrong error bars.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis::film_ensemble_test {
namespace {

struct Case {
  std::string name;
  ProgramLaw law;
  std::vector<std::string> estimates;
};

class FilmEnsemble : public testing::TestWithParam<Case> {};

TEST_P(FilmEnsemble, OfWalledFilmsFollowsTheExactLaw) {
  constexpr int kFilms = 150;
  EnsembleCurves curves;
  for (int i = 0; i < kFilms; ++i) {
    WalkerRecording film;
    film.law = GetParam().law;
    film.duration = 1800;
    film.walls = true;
    film.seed = 20000U + static_cast<unsigned>(i);
    curves.add(analyseRecording(film, stitch(film)));
  }
  expectUnbiased(curves.msd, kFilms, "MSD");
  expectUnbiased(curves.angular, kFilms, "angular MSD");
}

TEST_P(FilmEnsemble, HasTheStatedErrorsUpToAFilmOver180) {
  WalkerRecording film;
  film.law = GetParam().law;
  film.duration = 900;
  film.fps = 24.3;
  film.telemetry_rate = 20;
  const Coverage dut = cover(film, 300, 5);
  expectTrueErrors(dut.curves.msd, film.duration);
  expectTrueErrors(dut.curves.angular, film.duration);
  EXPECT_LE(dut.disagreements, 3);  // 1 %
}

TEST_P(FilmEnsemble, OfShortFilmsCoversTheTruthAtTheStatedRate) {
  const Coverage dut = cover(shortRecording(GetParam().law), 1000, 10);
  for (const std::string& name : GetParam().estimates) {
    expectCoverage(dut, name);
    const double deviation = dut.value.at(name).deviation();
    EXPECT_NEAR(dut.sigma.at(name).mean() / deviation, 1, 0.15) << name;
    // A ratio of fluctuating numbers has a bias of second order.
    EXPECT_NEAR(dut.value.at(name).mean(), dut.theory.at(name), 0.25 * deviation) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Programs, FilmEnsemble,
    testing::Values(Case{"AbpFig2b", abpLaw(3, 0.5), {"D_r", "v", "D", "L_s"}},
                    Case{"AbpEta1", abpLaw(1, 0.25), {"D_r", "v", "D", "L_s"}},
                    Case{"NoisyAbp", noisyLaw(0.01, 0.1, 0.1), {"D_r", "v_a", "V", "D_t"}},
                    Case{"Bp", noisyLaw(0, 0.07, 0.2), {"D_r", "v", "V", "D_t", "D"}},
                    Case{"Rtp", rtpLaw(1, 0.5), {"v", "gamma", "tau_r", "D", "L_s"}}),
    [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace lab::analysis::film_ensemble_test
