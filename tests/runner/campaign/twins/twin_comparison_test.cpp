#include "runner/campaign/twins/twin_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/math/random.hpp"

namespace lab::runner::campaign::twin_comparison_test {
namespace {

using testing::Contains;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kTwins = 40;

/// The numbers of one run: curves and estimates that share their errors, and one of its own, some
/// of them skewed as mean squares are.
std::vector<double> numbersOfRun(Random& random, int count) {
  std::vector<double> numbers;
  double walk = 0;
  for (int i = 0; i < count; ++i) {
    const double z = random.normal();
    walk = 0.8 * walk + 0.6 * z;
    numbers.push_back(i % 3 == 0 ? std::exp(0.3 * walk) : 5 + walk);
  }
  return numbers;
}

std::vector<Look> looksOfRuns(Random& random, int count, int twins) {
  std::vector<Look> looks(static_cast<std::size_t>(count));
  for (int run = -1; run < twins; ++run) {
    const std::vector<double> numbers = numbersOfRun(random, count);
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (run < 0) {
        looks[i].name = std::to_string(i);
        looks[i].run = numbers[i];
      } else {
        looks[i].twins.push_back(numbers[i]);
      }
    }
  }
  return looks;
}

TEST(TwinComparison, HasFewFalseAlarmsWithManyLooks) {
  constexpr int kTrials = 300;
  Random random(11);
  int below_1 = 0;
  int below_20 = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double p = compareWithTwins(looksOfRuns(random, 30, kTwins)).p;
    if (p < 0.01) ++below_1;
    if (p < 0.2) ++below_20;
  }

  // 1 % and three standard errors of it. Not so few that nothing could be found: the twins'
  // own maxima make the comparison cautious by up to a half.
  EXPECT_LE(below_1, 8);
  EXPECT_GE(below_20, 0.07 * kTrials);
  EXPECT_LE(below_20, 0.27 * kTrials);
}

TEST(TwinComparison, FindsTheLookThatDeviates) {
  Random random(12);
  std::vector<Look> looks = looksOfRuns(random, 30, kTwins);
  looks[7].run += 9;

  const TwinComparison comparison = compareWithTwins(looks);

  EXPECT_LT(comparison.p, 0.01);
  EXPECT_EQ(comparison.looks[comparison.most].name, "7");
  EXPECT_EQ(comparison.looks[7].below, kTwins);
  EXPECT_EQ(comparison.looks[7].above, 0);
  EXPECT_GT(comparison.looks[7].run, comparison.looks[7].high95);
}

TEST(TwinComparison, TakesTheNumberOfLooksIntoAccount) {
  Random random(13);
  std::vector<Look> looks = looksOfRuns(random, 30, kTwins);
  const TwinComparison all = compareWithTwins(looks);

  for (const PlacedLook& look : all.looks) {
    EXPECT_GE(look.p_all, look.p * 0.99) << look.name;
    const TwinComparison alone =
        compareWithTwins({*std::ranges::find(looks, look.name, &Look::name)});
    EXPECT_LE(alone.p, look.p_all + 0.02) << look.name;
  }
}

TEST(TwinComparison, ComparesConstantsByTheirRank) {
  const TwinComparison same = compareWithTwins({{"c", 3, std::vector<double>(kTwins, 3.0)}});
  const TwinComparison other = compareWithTwins({{"c", 4, std::vector<double>(kTwins, 3.0)}});

  EXPECT_EQ(same.p, 1);
  EXPECT_NEAR(other.p, 2.0 / (kTwins + 1), 1e-12);
}

TEST(TwinComparison, NamesWhatWasNotMeasured) {
  Random random(14);
  std::vector<Look> looks = looksOfRuns(random, 3, kTwins);
  looks[1].run = kNone;
  std::fill_n(looks[2].twins.begin(), kTwins / 2, kNone);

  const TwinComparison comparison = compareWithTwins(looks);

  ASSERT_EQ(comparison.looks.size(), 1);
  EXPECT_THAT(comparison.absent, Contains("1"));
  EXPECT_THAT(comparison.absent, Contains("2"));
}

TEST(TwinComparison, TakesEstimatesCurvesAndCollectiveNumbersFromSummaries) {
  constexpr const char* kSummary = R"({"programs": [{"name": "abp", "pool": {
      "contact_share": 0.1,
      "estimates": {"D_r_rad2_s": {"value": 0.75, "standard_error": 0.01}},
      "fit": {"derived": {"D_r_rad2_s": {"value": 0.76, "standard_error": 0.01}}},
      "msd": {"lag_s": [0.9, 1.0, 1.3, 2.1, 3.0], "value_cm2": [1, 2, 3, 4, 5]}}}],
    "collective": {"polarisation": {"value": 0.2, "standard_error": 0.1}}})";

  const std::vector<SummaryLook> looks = looksOf(kSummary);

  const auto value = [&](const std::string& name) {
    const auto found = std::ranges::find(looks, name, &SummaryLook::name);
    return found == looks.end() ? kNone : found->value;
  };
  EXPECT_EQ(value("abp.D_r_rad2_s"), 0.75);
  EXPECT_EQ(value("abp.contact_share"), 0.1);
  EXPECT_EQ(value("collective.polarisation"), 0.2);
  EXPECT_EQ(value("abp.msd at 1 s (cm2)"), 2);
  EXPECT_EQ(value("abp.msd at 2 s (cm2)"), 4);
  EXPECT_EQ(looks.size(), 5U);
}

TEST(TwinComparison, JoinsTheSummariesOfRunAndTwinsByName) {
  const std::string run =
      R"({"programs": [{"name": "abp", "pool": {"estimates": {"v": {"value": 3, "standard_error": 1}}}}]})";
  const std::string other =
      R"({"programs": [{"name": "rtp", "pool": {"estimates": {"v": {"value": 4, "standard_error": 1}}}}]})";

  const std::vector<Look> looks = looksOf(run, {run, other});

  ASSERT_EQ(looks.size(), 1);
  EXPECT_EQ(looks[0].twins[0], 3);
  EXPECT_TRUE(std::isnan(looks[0].twins[1]));
}

}  // namespace
}  // namespace lab::runner::campaign::twin_comparison_test
