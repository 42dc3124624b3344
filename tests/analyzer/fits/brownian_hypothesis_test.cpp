#include "analyzer/fits/brownian_hypothesis.hpp"

#include <gtest/gtest.h>

#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

ProgramLaw bp(double amplitude, double epsilon) {
  ProgramLaw law;
  law.kind = ProgramKind::kBp;
  law.V = amplitude;
  law.epsilon = epsilon;
  return law;
}

BrownianTest testOf(const WalkerRecording& film, const ProgramLaw& asked) {
  const StitchedRecording stitched = stitch(film);
  ProgramAnalysis analysis(asked, 1 / film.fps, 100);
  for (const Sample& sample : stitched.samples) analysis.add(sample);
  const auto test = testBrownian(asked, analysis.data());
  return test.value_or(BrownianTest{});
}

TEST(BrownianTest, ARobotsOwnAxisIsSeenInOneHour) {
  WalkerRecording film;
  film.law = bp(0.07, 0.2);
  film.duration = 3600;
  film.fps = 10.3;
  film.sigma = 0.0005;
  film.sigma_theta = 0.01;
  const BrownianTest test = testOf(film, film.law);
  ASSERT_GE(test.lags.size(), 6U);
  EXPECT_TRUE(test.isotropic.rejected) << test.text;
  EXPECT_FALSE(test.exact.rejected) << test.text;
  EXPECT_EQ(test.text.rfind("Not Brownian motion in the plane: kurtosis 2.", 0), 0U) << test.text;
}

TEST(BrownianTest, AnotherLawIsRejected) {
  // Robots that turn twenty times as fast are isotropic within a second: not the programmed law.
  WalkerRecording film;
  film.law = bp(0.07, 0.2);
  film.law.wheel_base = 0.075 / 6;
  film.duration = 3600;
  film.fps = 10.3;
  const BrownianTest test = testOf(film, bp(0.07, 0.2));
  ASSERT_FALSE(test.lags.empty());
  EXPECT_TRUE(test.exact.rejected) << test.text;
}

TEST(BrownianTest, IsForBrownianParticlesWithEnoughData) {
  WalkerRecording film;
  film.law = bp(0.07, 0.2);
  film.duration = 2;
  film.fps = 10.3;
  const StitchedRecording stitched = stitch(film);
  ProgramAnalysis analysis(film.law, 1 / film.fps, 100);
  for (const Sample& sample : stitched.samples) analysis.add(sample);
  EXPECT_FALSE(testBrownian(film.law, analysis.data()));
  ProgramLaw abp;
  abp.kind = ProgramKind::kAbp;
  EXPECT_FALSE(testBrownian(abp, analysis.data()));
  EXPECT_FALSE(testBrownian(film.law, BlockData{}));
}

TEST(BrownianTest, RejectsTheTruthAsRarelyAsItSays) {
  int rejected = 0;
  constexpr int kFilms = 100;
  Scatter largest;
  for (int i = 0; i < kFilms; ++i) {
    WalkerRecording film;
    film.law = bp(0.07, 0.2);
    film.duration = 1200;
    film.fps = 10.3;
    film.seed = static_cast<std::uint64_t>(100 + i);
    const BrownianTest test = testOf(film, film.law);
    rejected += test.exact.rejected ? 1 : 0;
    for (const KurtosisPoint& lag : test.lags) largest.add(std::abs(lag.z_exact));
  }
  RecordProperty("rejected", rejected);
  RecordProperty("mean_abs_z_percent", static_cast<int>(100 * largest.mean()));
  // One is expected; more than 4 have a chance of 4 in 1000 (the films are always the same).
  EXPECT_LE(rejected, 4);
}

}  // namespace
}  // namespace lab::analysis
