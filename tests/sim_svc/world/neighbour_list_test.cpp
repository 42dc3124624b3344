#include "sim_svc/world/neighbour_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"

namespace lab::sim {
namespace {

void expectAllPairs(const Arena& arena, int n, double cutoff, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec> points;
  for (int i = 0; i < n; ++i) {
    points.push_back({arena.width * random.uniform(), arena.height * random.uniform()});
  }
  NeighbourList dut;
  dut.build(points, arena, cutoff);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t j = 0; j < points.size(); ++j) {
      const double distance = std::hypot(points[i].x - points[j].x, points[i].y - points[j].y);
      if (j != i && distance < cutoff) expected.push_back(j);
    }
    std::vector<std::uint32_t> found(dut.of(i).begin(), dut.of(i).end());
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << i;
  }
}

TEST(NeighbourList, FindsTheSamePairsAsComparingAllPoints) {
  expectAllPairs({1.2, 0.9}, 150, 0.17, 1);
  expectAllPairs({8.5, 6.4}, 1000, 0.17, 2);
  expectAllPairs({1.2, 0.9}, 40, 2.0, 3);
  expectAllPairs({500, 400}, 300, 0.5, 4);
}

TEST(NeighbourList, WorksForNoneAndForOnePoint) {
  NeighbourList dut;
  dut.build({}, {1.2, 0.9}, 0.2);
  const std::vector<Vec> one = {{1.2, 0.9}};
  dut.build(one, {1.2, 0.9}, 0.2);
  EXPECT_TRUE(dut.of(0).empty());
}

}  // namespace
}  // namespace lab::sim
