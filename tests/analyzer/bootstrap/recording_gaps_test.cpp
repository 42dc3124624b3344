#include "analyzer/bootstrap/recording_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::analysis {
namespace {

TEST(SegmentLengths, GiveTheShareOfRemainingWindows) {
  SegmentLengths dut;
  EXPECT_EQ(dut.covered(10), 1);
  for (int i = 0; i < 30; ++i) dut.add(100);
  dut.add(1000);
  EXPECT_EQ(dut.number(), 31);
  EXPECT_EQ(dut.covered(0), 1);
  // Bins are a quarter of an octave wide.
  EXPECT_NEAR(dut.covered(50), (30 * 50 + 950) / 4000.0, 0.06);
  EXPECT_NEAR(dut.covered(500), 500 / 4000.0, 0.02);
  EXPECT_EQ(dut.covered(2000), 0);
}

TEST(RecordingGaps, AreEqualInSimulatedAndMeasuredRecordings) {
  RecordingGaps gaps;
  gaps.lost = 0.2;
  gaps.lost_length = 3;
  gaps.cut = true;
  for (int i = 0; i < 90; ++i) gaps.segments.add(20);
  for (int i = 0; i < 10; ++i) gaps.segments.add(500);
  constexpr std::size_t kFrames = 2'000'000;
  constexpr std::size_t kLag = 40;
  const RecordingStretches dut = drawStretches(gaps, 0.05, 0.05, kFrames, 1);
  double lost = 0;
  double lost_runs = 0;
  double cuts = 0;
  double windows = 0;
  for (std::size_t i = 1; i < kFrames; ++i) {
    const bool is_lost = dut.of_places[i] < 0;
    lost += is_lost ? 1 : 0;
    lost_runs += is_lost && dut.of_places[i - 1] >= 0 ? 1 : 0;
    if (is_lost) continue;
    cuts = dut.of_places[i];
    // A heading is followed within a segment, and across gaps of 0.3 s at most.
    EXPECT_GE(dut.of_headings[i], dut.of_places[i]);
    if (i >= kLag && dut.of_places[i - kLag] == dut.of_places[i]) windows += 1;
  }
  EXPECT_NEAR(lost / kFrames, 0.2, 0.003);
  EXPECT_NEAR(lost / lost_runs, 3, 0.05);
  EXPECT_NEAR(kFrames / cuts, 68, 68 * 0.1);  // the mean segment, in bins of a quarter octave
  EXPECT_NEAR(windows / kFrames, gaps.covered(kLag) * 0.8 * 0.8, 0.02);
  EXPECT_GT(dut.of_headings.back(), dut.of_places.back());
}

TEST(RecordingGaps, LoseFewerFramesAtALowerFrameRate) {
  RecordingGaps gaps;
  gaps.lost = 0.1;
  const RecordingStretches dut = drawStretches(gaps, 0.01, 0.04, 400'000, 1);
  double lost = 0;
  for (const int stretch : dut.of_places) lost += stretch < 0 ? 1 : 0;
  EXPECT_NEAR(lost / 400'000, 0.1 / 0.9 / 4 / (1 + 0.1 / 0.9 / 4), 0.001);
}

}  // namespace
}  // namespace lab::analysis
