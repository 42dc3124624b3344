#include "analyzer/curves/block_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lab::analysis {
namespace {

BlockSums block(double time, double forward) {
  BlockSums sums;
  sums.time = time;
  sums.forward = forward;
  sums.forward_time = time;
  return sums;
}

std::vector<double> meanSpeed(const BlockSums& sums) { return {sums.forward / sums.forward_time}; }

double forwardOf(const BlockGroup& group) {
  double forward = 0;
  for (std::size_t b = group.begin; b < group.end; ++b) forward += (*group.track)[b].forward;
  return forward;
}

/// Every block is a group of its own.
Replicates jackknifeOf(const std::vector<BlockSums>& blocks) {
  BlockData data;
  for (const BlockSums& one : blocks) data.tracks.push_back({one});
  return jackknife(groupBlocks(data, 0), data.total(), {}, meanSpeed);
}

TEST(GroupBlocks, MergesAdjacentBlocksOfOneRobotOnly) {
  BlockData data;
  data.tracks = {{block(1, 1), block(1, 2), block(1, 3), block(1, 4), block(1, 5)}, {block(1, 6)}};
  const std::vector<BlockGroup> dut = groupBlocks(data, 2);
  ASSERT_EQ(dut.size(), 3U);
  EXPECT_DOUBLE_EQ(forwardOf(dut[0]), 3);
  EXPECT_DOUBLE_EQ(forwardOf(dut[1]), 12);  // the remainder joins the group before it
  EXPECT_DOUBLE_EQ(forwardOf(dut[2]), 6);   // all there is of its robot
}

TEST(Jackknife, GivesTheStandardErrorOfTheMeanForEqualBlocks) {
  const std::vector<double> values{1, 4, 2, 5, 3, 9};
  std::vector<BlockSums> blocks;
  for (const double value : values) {
    blocks.push_back(block(1, value));
  }
  const Replicates dut = jackknifeOf(blocks);
  EXPECT_DOUBLE_EQ(dut.values[0], 4);
  EXPECT_NEAR(dut.sigma(0), std::sqrt((9 + 0 + 4 + 1 + 1 + 25) / 5.0 / 6.0), 1e-12);
  EXPECT_NEAR(dut.degreesOfFreedom(), 5, 1e-9);
}

TEST(Jackknife, GivesTheTrueErrorForUnequalBlocks) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double variance = 0;
  double claimed = 0;
  const int recordings = 4000;
  for (int recording = 0; recording < recordings; ++recording) {
    std::vector<BlockSums> blocks;
    for (int i = 0; i < 20; ++i) {
      const double time = 1 + i % 4;
      blocks.push_back(block(time, time + std::sqrt(time) * normal(random)));
    }
    const Replicates dut = jackknifeOf(blocks);
    variance += std::pow(dut.values[0] - 1, 2) / recordings;
    claimed += std::pow(dut.sigma(0), 2) / recordings;
  }
  EXPECT_NEAR(claimed / variance, 1,
              0.1);  // the scatter of a variance over 4000 recordings is 2.2 %
}

TEST(Jackknife, GivesNanForASingleBlock) {
  const Replicates dut = jackknifeOf({block(1, 1)});
  EXPECT_TRUE(std::isnan(dut.sigma(0)));
}

}  // namespace
}  // namespace lab::analysis
