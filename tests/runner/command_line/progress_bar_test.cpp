#include "runner/command_line/progress_bar.hpp"

#include <gtest/gtest.h>

namespace lab::runner {
namespace {

TEST(ProgressBar, ShowsProgressAndRemainingTime) {
  EXPECT_EQ(progressBarText(100, 400, 2),
            "[######..................] 100 of 400 frames, 50 a second, 6 s left");
}

TEST(ProgressBar, ShowsNoRemainingTimeIfTheLengthIsUnknown) {
  EXPECT_EQ(progressBarText(100, 0, 2), "100 frames, 50 a second");
}

TEST(ProgressBar, AllowsMoreFramesThanAnnounced) {
  EXPECT_EQ(progressBarText(500, 400, 5),
            "[########################] 500 of 400 frames, 100 a second, 0 s left");
  EXPECT_EQ(progressBarText(0, 400, 0), "[........................] 0 of 400 frames, 0 a second");
}

}  // namespace
}  // namespace lab::runner
