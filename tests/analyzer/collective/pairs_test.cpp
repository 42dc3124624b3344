#include "analyzer/collective/pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <utility>

namespace lab::collective::pairs_test {
namespace {

std::vector<Point> randomPoints(std::size_t count) {
  std::mt19937_64 random(count);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({unit(random), unit(random)});
  return points;
}

TEST(Pairs, AreAllThoseCloserThanTheDistanceOnce) {
  const std::vector<Point> points = randomPoints(200);
  std::set<std::pair<std::size_t, std::size_t>> expected;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double r = std::hypot(points[i].x - points[j].x, points[i].y - points[j].y);
      if (r < 0.15) expected.emplace(i, j);
    }
  }
  std::vector<std::size_t> order;

  std::set<std::pair<std::size_t, std::size_t>> found;
  int visits = 0;
  forEachPair(points, 0.15, order,
              [&](std::size_t i, std::size_t j, double dx, double dy, double r2) {
                found.insert(std::minmax(i, j));
                ++visits;
                EXPECT_DOUBLE_EQ(dx, points[j].x - points[i].x);
                EXPECT_DOUBLE_EQ(dy, points[j].y - points[i].y);
                EXPECT_DOUBLE_EQ(r2, dx * dx + dy * dy);
              });

  EXPECT_EQ(found, expected);
  EXPECT_EQ(static_cast<std::size_t>(visits), expected.size());
}

TEST(Clusters, AreTheConnectedParts) {
  const std::vector<Point> points = randomPoints(300);
  constexpr double kDistance = 0.05;
  std::vector<int> part(points.size(), -1);
  int parts = 0;
  const std::function<void(std::size_t)> flood = [&](std::size_t i) {
    part[i] = parts;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double r = std::hypot(points[i].x - points[j].x, points[i].y - points[j].y);
      if (part[j] < 0 && r < kDistance) flood(j);
    }
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (part[i] >= 0) continue;
    flood(i);
    ++parts;
  }

  Clusters clusters;
  clusters.reset(points.size());
  std::vector<std::size_t> order;
  forEachPair(points, kDistance, order,
              [&](std::size_t i, std::size_t j, double, double, double) { clusters.join(i, j); });

  ASSERT_GT(parts, 20);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_EQ(clusters.root(i) == clusters.root(j), part[i] == part[j]);
    }
  }
}

}  // namespace
}  // namespace lab::collective::pairs_test
