/// Accuracy limits of some kinds of pictures, with few pictures each, and the limits themselves.
/// The benchmark tests/benchmarks/tracker_kinds has all kinds with more pictures.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/tracker_scenes/acceptance_limits.hpp"
#include "tests/support/tracker_scenes/scenes.hpp"

namespace lab::cases {
namespace {

std::string textOf(const AcceptanceLimits& bars, const Tally& tally) {
  std::string text;
  for (const Shortfall& one : shortOf(bars, tally)) text += one.what + "; ";
  return text;
}

struct Few {
  const char* kind;
  std::uint64_t seeds;
};

class FewPictures : public testing::TestWithParam<Few> {};

TEST_P(FewPictures, MeetTheLimitsOfTheirKind) {
  const SceneKind& kind = kindOf(GetParam().kind);
  Score score;
  for (std::uint64_t seed = 1; seed <= GetParam().seeds; ++seed) look(kind, seed, false, score);
  EXPECT_EQ(textOf(kind.limits, score.tally()), "") << Score::header() << '\n' << score.text();
}

INSTANTIATE_TEST_SUITE_P(Kinds, FewPictures,
                         testing::Values(Few{"clean_720", 2}, Few{"light_uniform05", 1},
                                         Few{"light_half_100_12", 1}, Few{"light_checker", 1},
                                         Few{"dis_nobody_checker", 1}, Few{"opt_noise", 1},
                                         Few{"opt_jpeg_05", 1}, Few{"dis_nobody_jpeg", 1},
                                         Few{"opt_gamma_05", 1}, Few{"opt_webcam", 1},
                                         Few{"dis_nobody_webcam", 1}, Few{"opt_defocus25", 1},
                                         Few{"worst_720", 1}),
                         [](const auto& each) { return std::string(each.param.kind); });

// Kinds with light that no simple model describes: no accuracy limit, but the covariances must
// hold.
class OddLight : public testing::TestWithParam<const char*> {};

TEST_P(OddLight, HasTheErrorsOfItsCovariance) {
  Score score;
  look(kindOf(GetParam()), 1, false, score);
  const Tally tally = score.tally();
  EXPECT_GT(tally.nees_count, 30) << score.text();
  EXPECT_NEAR(tally.nees, 1, allowedNees(tally)) << score.text();
}

INSTANTIATE_TEST_SUITE_P(Kinds, OddLight,
                         testing::Values("light_wave", "light_noise", "light_stripes_fine"),
                         [](const auto& each) { return std::string(each.param); });

TEST(AcceptanceLimits, AllowForChance) {
  // 4 of 800 are expected at 99.5 %: 9 happen in one of 47 runs, 10 in one of 123 (Poisson).
  EXPECT_NEAR(chanceOf(9, 4), 0.0214, 1e-4);
  EXPECT_NEAR(chanceOf(10, 4), 0.0081, 1e-4);
  const AcceptanceLimits most{.recall = 0.995, .wrong = 0.1};
  EXPECT_EQ(textOf(most, {.frames = 20, .robots = 800, .found = 791, .wrong = 6}), "");
  EXPECT_EQ(shortOf(most, {.frames = 20, .robots = 800, .found = 790, .wrong = 7}).size(), 2U);
  const AcceptanceLimits all{.recall = 1, .wrong = 0};
  EXPECT_EQ(textOf(all, {.frames = 20, .robots = 800, .found = 800}), "");
  EXPECT_EQ(shortOf(all, {.frames = 20, .robots = 800, .found = 799, .wrong = 1}).size(), 2U);
  EXPECT_EQ(shortOf(all, {.frames = 20, .robots = 800, .found = 800, .flipped = 1}).size(), 1U);
}

TEST(AcceptanceLimits, TestErrorsAndCovariances) {
  const AcceptanceLimits bars{.position = 0.012, .heading = 0.03, .honest = true};
  Tally tally{.position = 0.012, .heading = 0.03, .nees = 1.18, .nees_count = 800};
  EXPECT_EQ(textOf(bars, tally), "");
  tally.nees = 0.8;  // limits 1 +- (0.1 + 3 sqrt(2 / 2400)): 0.813 to 1.187
  EXPECT_EQ(shortOf(bars, tally).size(), 1U);
  tally = {.position = 0.0121, .heading = 0.031, .nees = 1.19, .nees_count = 800};
  EXPECT_EQ(shortOf(bars, tally).size(), 3U);
  EXPECT_EQ(textOf({}, tally), "");
}

TEST(AcceptanceLimits, MayBeMarkedAsNotReached) {
  const std::vector<Shortfall> left = shortOf({.recall = 1, .wrong = 0, .recall_known = 0.9},
                                              {.frames = 1, .robots = 10, .found = 9, .wrong = 1});
  ASSERT_EQ(left.size(), 2U);
  EXPECT_TRUE(left[0].known);
  EXPECT_FALSE(left[1].known);
}

}  // namespace
}  // namespace lab::cases
