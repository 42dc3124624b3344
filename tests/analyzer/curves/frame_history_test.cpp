#include "analyzer/curves/frame_history.hpp"

#include <gtest/gtest.h>

namespace lab::analysis::frame_history_test {
namespace {

constexpr double kPeriod = 0.02;  // s

/// Frames whose x is their slot and whose time is exact.
void push(FrameHistory& history, int frames) {
  for (int i = 0; i < frames; ++i) {
    if (history.full()) history.retire();
    const auto slot = static_cast<double>(history.newest() + 1);
    history.push({0, kPeriod * slot, slot, -slot, 2 * slot});
  }
}

FrameHistory begun() {
  FrameHistory history;
  history.forget();
  return history;
}

TEST(FrameHistory, FindsTheFramesOfTheHistoryAndOfTheCollection) {
  FrameHistory dut = begun();
  for (int n = 1; n <= 300; ++n) {
    push(dut, 1);
    EXPECT_EQ(dut.newest(), n - 1);
    for (std::int64_t back = 0; back < 80; ++back) {
      const auto fix = dut.find(dut.newest() - back);
      ASSERT_EQ(fix.has_value(), back < n) << n << " " << back;
      if (!fix) continue;
      EXPECT_EQ(fix->slot, dut.newest() - back);
      EXPECT_EQ(fix->x, static_cast<double>(fix->slot));
      EXPECT_EQ(fix->y, -fix->x);
      EXPECT_EQ(fix->theta, 2 * fix->x);
    }
    EXPECT_FALSE(dut.find(n));
  }
}

TEST(FrameHistory, FindsNothingInPlaceOfLostFrames) {
  for (const int lost : {1, 2, 63, 65, 79, 80, 81, 1000}) {
    FrameHistory dut = begun();
    push(dut, 100);
    dut.retire();
    dut.lose(lost);
    push(dut, 3);
    EXPECT_EQ(dut.newest(), 102 + lost);
    for (std::int64_t slot = 100; slot < 100 + lost; ++slot) EXPECT_FALSE(dut.find(slot)) << slot;
    for (std::int64_t slot = 20 + lost; slot < 100; ++slot) {
      ASSERT_TRUE(dut.find(slot)) << lost << " " << slot;
      EXPECT_EQ(dut.find(slot)->x, static_cast<double>(slot));
    }
    EXPECT_EQ(dut.find(100 + lost)->x, 100 + lost);
  }
}

TEST(FrameHistory, ForgetDiscardsAllFrames) {
  FrameHistory dut = begun();
  push(dut, 100);
  dut.retire();
  dut.forget();
  push(dut, 1);
  for (std::int64_t slot = dut.newest() - 80; slot < dut.newest(); ++slot) {
    EXPECT_FALSE(dut.find(slot));
  }
  EXPECT_TRUE(dut.find(dut.newest()));
}

TEST(FrameHistory, InterpolatesAcrossAtMostOneLostFrame) {
  for (const int lost : {0, 1, 2}) {
    FrameHistory dut = begun();
    push(dut, 100);
    dut.retire();
    dut.lose(lost);
    push(dut, 3);
    const double at = 99.3;
    const auto fix = dut.interpolated(kPeriod * at, 101, kPeriod);
    ASSERT_EQ(fix.has_value(), lost < 2);
    if (!fix) continue;
    EXPECT_EQ(fix->slot, 99);
    EXPECT_NEAR(fix->x, at, 1e-9);
    EXPECT_NEAR(fix->theta, 2 * at, 1e-9);
    EXPECT_FALSE(dut.interpolated(kPeriod * (102.5 + lost), dut.newest(), kPeriod));
  }
}

}  // namespace
}  // namespace lab::analysis::frame_history_test
