#include "analyzer/curves/turning_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/analyzer/program_films.hpp"

namespace lab::analysis::turning_rate_test {
namespace {

using Changes = std::vector<language::NamedText>;

constexpr double kHalfHour = 1800;

Changes abpChanges() { return {{"v", "3 cm/s"}, {"epsilon", "0.5 s"}, {"eta", "3 rad/s"}}; }

FilmOptions film() {
  FilmOptions options;
  options.duration = kHalfHour;
  return options;
}

ProgramResult judged(const Program& filmed, std::uint64_t seed) {
  const ProgramLaw law = lawOf(shippedProgram("abp", abpChanges()), bodyFor(film()));
  return analyse(law, filmOf(filmed, law, seed, film()), {}, {});
}

// Its D_r is 0.75 rad^2/s, so half an hour gives 0.029 rad/s. Neither curve shows the circling.
TEST(TurningRate, ARobotThatSlowlyCirclesDeviates) {
  Changes changes = abpChanges();
  changes.push_back({"omega", "0.2 rad/s"});
  const ProgramResult result = judged(shippedProgram("chiral_abp", changes), 3);

  ASSERT_TRUE(result.curves.turning);
  EXPECT_NEAR(result.curves.turning->sigma, std::sqrt(2 * 0.75 / kHalfHour), 0.001);
  EXPECT_NEAR(result.curves.turning->value, 0.2, 4 * 0.029);
  EXPECT_EQ(result.verdict.kind, VerdictKind::kDisagrees);
  EXPECT_TRUE(result.verdict.turning);
}

TEST(TurningRate, OfFaithfulRobotsHasTheErrorOfTheLaw) {
  constexpr int kFilms = 60;
  double sum = 0;
  double squares = 0;
  for (int seed = 1; seed <= kFilms; ++seed) {
    const ProgramResult result =
        judged(withoutLaw("abp", abpChanges()), static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(result.curves.turning);
    sum += result.curves.turning->z;
    squares += result.curves.turning->z * result.curves.turning->z;
  }
  EXPECT_LT(std::abs(sum) / std::sqrt(kFilms), 4);
  EXPECT_LT(std::abs(squares - kFilms) / std::sqrt(2.0 * kFilms), 4);
}

TEST(TurningRate, IsOnlyJudgedForLawsThatTurnToBothSides) {
  const ProgramLaw chiral = lawOf(shippedProgram("chiral_abp", {}), 0.075);
  BlockSums total;
  total.turn = 100;
  total.turn_time = 100;
  EXPECT_FALSE(turningRate(chiral, total));
  const ProgramLaw rtp = lawOf(shippedProgram("rtp", {}), 0.075);
  ASSERT_TRUE(turningRate(rtp, total));
  // Each second 1 / (1/3 + 0.5) tumbles, by angles whose mean square is pi^2 / 3.
  EXPECT_NEAR(turningRate(rtp, total)->sigma, std::sqrt(1.2 * M_PI * M_PI / 3 / 100), 0.01);
  EXPECT_FALSE(turningRate(rtp, BlockSums{}));
}

}  // namespace
}  // namespace lab::analysis::turning_rate_test
