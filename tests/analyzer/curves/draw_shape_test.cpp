#include "analyzer/curves/draw_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "tests/analyzer/program_films.hpp"
#include "tests/robot/programs.hpp"

namespace lab::analysis::draw_shape_test {
namespace {

constexpr double kHalfHour = 1800;

FilmOptions film() {
  FilmOptions options;
  options.duration = kHalfHour;
  return options;
}

Program asked() {
  return shippedProgram("abp", {{"v", "3 cm/s"}, {"epsilon", "0.9 s"}, {"eta", "3 rad/s"}});
}

/// With normal draws of the same variance.
Program withNormalDraws() {
  language::ProgramText text = abpText("3 cm/s", "0.9 s", "3 rad/s");
  text.phases.front().turn = "normal(0, eta / sqrt(3))";
  Program program = withoutLaw("abp");
  program.code = codeOf(text);
  program.hash = hashOf(text);
  return program;
}

ProgramResult judged(const Program& filmed, std::uint64_t seed) {
  const ProgramLaw law = lawOf(asked(), bodyFor(film()));
  return analyse(law, filmOf(filmed, law, seed, film()), {}, {});
}

TEST(DrawShape, OfFaithfulRobotsIsUniform) {
  constexpr int kFilms = 40;
  double sum = 0;
  double squares = 0;
  Program faithful = asked();
  faithful.law = {};
  for (int seed = 1; seed <= kFilms; ++seed) {
    const ProgramResult result = judged(faithful, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(result.curves.draws);
    EXPECT_EQ(result.curves.draws->programmed, 1.8);
    const double z = (result.curves.draws->kurtosis - 1.8) / result.curves.draws->sigma;
    sum += z;
    squares += z * z;
  }
  EXPECT_LT(std::abs(sum) / std::sqrt(kFilms), 4);
  // The error of a jackknife scatters too.
  EXPECT_LT(squares, 2 * kFilms);
  EXPECT_GT(squares, 0.5 * kFilms);
}

// MSD and angular MSD are those of uniform draws with this variance.
TEST(DrawShape, NormalDrawsDeviate) {
  const ProgramResult result = judged(withNormalDraws(), 2);
  ASSERT_TRUE(result.curves.draws);
  EXPECT_NEAR(result.curves.draws->kurtosis, 3, 4 * result.curves.draws->sigma);
  EXPECT_EQ(result.verdict.kind, VerdictKind::kDisagrees);
  EXPECT_TRUE(result.verdict.draws);
  for (const CurvePoint& point : result.curves.angular_msd) {
    if (!point.judged) continue;
    EXPECT_LT(std::abs(point.z), 4) << point.tau;
  }
}

TEST(DrawShape, IsNotMeasuredWhereFramesMayKeepStep) {
  const ProgramLaw law = lawOf(shippedProgram("abp", {{"epsilon", "0.5 s"}}), bodyFor(film()));
  const BlockData data = filmOf(withoutLaw("abp", {{"epsilon", "0.5 s"}}), law, 1, film());
  EXPECT_FALSE(analyse(law, data, {}, {}).curves.draws);
}

}  // namespace
}  // namespace lab::analysis::draw_shape_test
