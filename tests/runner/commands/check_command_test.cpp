#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/commands/commands.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::check_command_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string checkOutputOf(const std::vector<std::string>& set) {
  const TemporaryFolder folder;
  const fs::path file = folder / "small.toml";
  support::writeFile(file, std::string(kSmall));
  testing::internal::CaptureStdout();
  EXPECT_EQ(check(file, set), kDone);
  std::fflush(stdout);
  return testing::internal::GetCapturedStdout();
}

TEST(CheckCommand, PrintsThePersistenceLengthOfTheExactLaw) {
  // The value of `lab theory` and of the report (tests/analyzer/laws_test.cpp); v / D_r is 4 cm.
  EXPECT_THAT(checkOutputOf({}), HasSubstr("L_s = 4.197 cm"));
  EXPECT_THAT(checkOutputOf({"programs.abp.epsilon_s=0.1", "programs.abp.eta_rad_s=6"}),
              HasSubstr("D_r = 0.6 rad^2/s, L_s = 5.0"));
}

TEST(CheckCommand, WarnsWhenTheFileAsksForMoreThanThisMachineHas) {
  EXPECT_THAT(checkOutputOf({}), Not(HasSubstr("warning")));
  EXPECT_THAT(checkOutputOf({"camera.tracker=camera", "camera.camera=sim", "camera.fps=500",
                             "camera.width_px=3840", "camera.height_px=2160"}),
              HasSubstr("warning       needs about "));
}

TEST(CheckCommand, CountsTheDashboardAsARunHasIt) {
  const char* before = std::getenv("CI");
  const std::optional<std::string> ci =
      before == nullptr ? std::nullopt : std::optional<std::string>(before);
  const std::vector<std::string> heavy{"camera.tracker=camera", "camera.camera=sim",
                                       "camera.fps=500", "camera.width_px=3840",
                                       "camera.height_px=2160"};
  unsetenv("CI");
  EXPECT_THAT(checkOutputOf(heavy), HasSubstr(", dashboard 0.03"));
  setenv("CI", "true", 1);
  EXPECT_THAT(checkOutputOf(heavy), Not(HasSubstr("dashboard")));
  if (ci) {
    setenv("CI", ci->c_str(), 1);
  } else {
    unsetenv("CI");
  }
}

TEST(CheckCommand, WarnsWhenTheLogDoesNotFitIntoTheFolderOfRuns) {
  EXPECT_THAT(checkOutputOf({}), Not(HasSubstr("too little disk")));
  // Some 400 TB.
  EXPECT_THAT(
      checkOutputOf({"duration_s=864000", "camera.fps=500", "robots[0].count=4000",
                     "arena.width_cm=1000", "arena.height_cm=1000"}),
      AllOf(HasSubstr("\nwarning       too little disk in runs: this run needs about "),
            // This command has no --runs.
            HasSubstr("; make room, give `lab run` another folder with --runs, or shorten ")));
}

}  // namespace
}  // namespace lab::runner::check_command_test
