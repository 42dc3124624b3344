#include "runner/live/progress_line.hpp"

#include <gtest/gtest.h>

namespace lab::runner {
namespace {

TEST(ProgressText, ShowsTimeLightRobotsProgramsAndLosses) {
  Progress progress;
  progress.left = 75.2;
  progress.light = "half: ABP";
  progress.robots_seen = 3;
  progress.robots_running = {{"abp", 2}, {"bp", 1}};
  progress.lost = 4;
  EXPECT_EQ(progressText(progress),
            "76 s left | light half: ABP | 3 robots seen | 2 abp, 1 bp | 4 messages lost");
}

TEST(ProgressText, ShowsTheProgressOfStopRules) {
  Progress progress;
  progress.left = 75.2;
  progress.at_most = true;
  progress.stop = "D_r of abp 7.3 %, wanted 5 %: about 12 s";
  EXPECT_EQ(
      progressText(progress),
      "at most 76 s left | D_r of abp 7.3 %, wanted 5 %: about 12 s | light - | 0 robots seen "
      "| no program | 0 messages lost");
}

TEST(ProgressText, ShowsHowManyRobotsAreStoppedAndWhatReleasesThem) {
  Progress progress;
  progress.left = 80;
  progress.robots_stopped = 20;
  progress.robots_running = {{"standing", 20}};
  EXPECT_EQ(progressText(progress),
            "80 s left | 20 robots STOPPED: lab stop --clear lets them go on | light - | 0 robots "
            "seen | 20 standing | 0 messages lost");
}

TEST(ProgressText, ShowsLongTimesInMinutesAndHours) {
  Progress progress;
  progress.left = 600;
  EXPECT_EQ(progressText(progress),
            "10 min 00 s left | light - | 0 robots seen | no program | 0 messages lost");
  progress.left = 2 * 3600 + 90;
  EXPECT_EQ(progressText(progress).substr(0, 15), "2 h 01 min left");
}

}  // namespace
}  // namespace lab::runner
