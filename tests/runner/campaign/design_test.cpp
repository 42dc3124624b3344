#include "runner/campaign/design.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign::design_test {
namespace {

using testing::ElementsAre;

Design designOf(const std::vector<std::string>& over) {
  Design design;
  design.axes = parseAxes(over);
  return design;
}

std::vector<double> column(const std::vector<PointValues>& points, std::size_t axis) {
  std::vector<double> values;
  for (const PointValues& point : points) values.push_back(numberIn(point[axis]).value());
  return values;
}

TEST(Design, CombinesAllValues) {
  EXPECT_THAT(pointsOf(designOf({"a=1,2", "b=x,y"})),
              ElementsAre(PointValues{"1", "x"}, PointValues{"1", "y"}, PointValues{"2", "x"},
                          PointValues{"2", "y"}));
}

TEST(Design, HasOnePointWithoutKeys) { EXPECT_THAT(pointsOf({}), ElementsAre(PointValues{})); }

TEST(Design, ZipsValuesOfTheSameNumber) {
  Design design = designOf({"a=1,2,3", "b=x,y,z"});
  design.zip = true;

  EXPECT_THAT(pointsOf(design),
              ElementsAre(PointValues{"1", "x"}, PointValues{"2", "y"}, PointValues{"3", "z"}));
}

TEST(Design, RefusesToZipUnequalNumbersOfValues) {
  Design design = designOf({"a=1,2,3", "b=x,y"});
  design.zip = true;

  EXPECT_THROW(static_cast<void>(pointsOf(design)), UserError);
}

TEST(Design, NeedsACountOrDrawsForARange) {
  Design design = designOf({"a=1:2"});
  EXPECT_THROW(static_cast<void>(pointsOf(design)), UserError);

  design.random = 5;
  EXPECT_EQ(pointsOf(design).size(), 5U);
}

TEST(Design, RefusesMorePointsThanAMachineCanHold) {
  EXPECT_THROW(static_cast<void>(pointsOf(designOf({"a=0:1:2000", "b=0:1:2000"}))), UserError);
}

TEST(Design, HasAtMostAHundredThousandPoints) {
  Design design = designOf({"a=0:1"});
  design.random = kMostPoints;
  EXPECT_EQ(pointsOf(design).size(), 100'000U);
  design.random = kMostPoints + 1;
  EXPECT_THAT([&] { (void)pointsOf(design); },
              testing::ThrowsMessage<UserError>(
                  testing::StartsWith("found a sweep of 100001 points, allowed 100000;")));
}

TEST(Design, HasOnePointOfALatinHypercubeInEachPartOfEveryAxis) {
  constexpr std::size_t kPoints = 50;
  Design design = designOf({"a=0:1", "b=1:100:log"});
  design.random = kPoints;
  const std::vector<PointValues> points = pointsOf(design);

  ASSERT_EQ(points.size(), kPoints);
  std::set<int> parts;
  for (const double value : column(points, 0)) parts.insert(static_cast<int>(value * kPoints));
  EXPECT_EQ(parts.size(), kPoints);
  parts.clear();
  for (const double value : column(points, 1)) {
    parts.insert(static_cast<int>(std::log(value) / std::log(100) * kPoints));
  }
  EXPECT_EQ(parts.size(), kPoints);
}

/// Counts points in 8 x 8 equal cells of two axes in [0, 1).
std::vector<int> cellCounts(const std::vector<PointValues>& points) {
  constexpr int kCells = 8;
  std::vector<int> counts(kCells * kCells);
  const std::vector<double> x = column(points, 0);
  const std::vector<double> y = column(points, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int cell = static_cast<int>(x[i] * kCells) * kCells + static_cast<int>(y[i] * kCells);
    ++counts[static_cast<std::size_t>(cell)];
  }
  return counts;
}

TEST(Design, FillsThePlaneEvenlyBySobolsSequence) {
  Design design = designOf({"a=0:1", "b=0:1"});
  design.random = 64;
  design.sampling = Sampling::kSobol;

  // The first 2^6 points of the sequence, also shifted, are a (0, 6, 2) net: one in each cell.
  EXPECT_THAT(cellCounts(pointsOf(design)), testing::Each(1));

  design.sampling = Sampling::kLatin;
  const std::vector<int> latin = cellCounts(pointsOf(design));
  EXPECT_GT(std::ranges::count(latin, 0), 0);
}

TEST(Design, DrawsOtherPointsFromAnotherSeedAndTheSameFromTheSame) {
  for (const Sampling sampling : {Sampling::kLatin, Sampling::kSobol}) {
    Design design = designOf({"a=0:1", "b=0:1"});
    design.random = 10;
    design.sampling = sampling;
    const std::vector<PointValues> points = pointsOf(design);

    EXPECT_EQ(pointsOf(design), points);
    design.seed = 2;
    EXPECT_NE(pointsOf(design), points);
  }
}

TEST(Design, DrawsListedValuesEquallyOften) {
  Design design = designOf({"a=x,y,z", "b=0:1"});
  design.random = 300;
  const std::vector<PointValues> points = pointsOf(design);

  for (const char* value : {"x", "y", "z"}) {
    EXPECT_EQ(std::ranges::count_if(points, [&](const PointValues& p) { return p[0] == value; }),
              100);
  }
}

}  // namespace
}  // namespace lab::runner::campaign::design_test
