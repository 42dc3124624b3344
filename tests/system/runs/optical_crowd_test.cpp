// Twenty robots that touch and pass each other before the simulated camera, while the projector is
// dark at times and frames are lost: identities must never be wrong. One minute in the CI tier, ten
// in the long tier.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>

#include "tests/support/lab_process.hpp"
#include "tests/system/runs/truth_comparison.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

bool isLong() { return std::getenv("LAB_LONG") != nullptr; }

/// @param ambient ambient light [1], the only light while the projector is dark
fs::path writeExperimentFile(const fs::path& folder, double ambient) {
  const double duration = isLong() ? 600 : 60;
  const fs::path file = folder / "crowd.toml";
  std::ofstream(file) << "fileversion = 1\nname = \"crowd\"\nseed = 11\nduration_s = " << duration
                      << "\n[[robots]]\nid = 1\ncount = 20\n"
                         "[programs.abp]\nmodel = \"abp\"\nv_cm_s = 5\nepsilon_s = 0.5\n"
                         "eta_rad_s = 3\n"
                         "[light_table]\nbands = [{light = [0, 1], program = \"abp\"}]\n"
                         "[reversal]\non = \"walls\"\ndistance_cm = 6\n"
                         "[light]\nrepeat = true\nlength_s = 30\n"
                         "[[light.steps]]\nat_s = 0\nlabel = \"lit\"\n"
                         "layers = [{kind = \"uniform\", intensity = 0.8}]\n"
                         "[[light.steps]]\nat_s = 20\nlabel = \"black\"\n"
                         "layers = [{kind = \"uniform\", intensity = 0}]\n"
                         "[[light.steps]]\nat_s = 22\nlabel = \"lit again\"\n"
                         "layers = [{kind = \"uniform\", intensity = 0.8}]\n"
                         "[camera]\ntracker = \"camera\"\nfps = 15\nframe_loss = 0.01\nambient = "
                      << ambient << "\n";
  return file;
}

TruthComparison runCrowd(double ambient) {
  const TemporaryFolder folder;
  const Finished lab =
      run("lab run " + writeExperimentFile(folder.path(), ambient).string() +
              " --virtual-time --no-report --out " + (folder.path() / "runs").string(),
          std::chrono::hours(1));
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, testing::Not(testing::HasSubstr("tracker saw no cap"))) << lab.output;
  const TruthComparison truth = compareWithTruth(onlyRun(folder.path() / "runs"));
  std::cout << truth.compared << " poses of known robots, " << truth.unidentified
            << " detections without identity; worst " << truth.worst * 1e3 << " mm, "
            << truth.worst_turn * 180 / std::numbers::pi << " degrees; " << truth.collisions
            << " collisions, " << truth.tracker.bindings << " bindings, "
            << truth.tracker.unbindings << " released, " << truth.tracker.flips
            << " flips refused\n";
  return truth;
}

TEST(OpticalCrowd, KeepsEveryIdentityWhileTheProjectorIsDark) {
  const TruthComparison truth = runCrowd(0.03);
  EXPECT_EQ(truth.swapped, 0);
  EXPECT_EQ(truth.flipped, 0);
  EXPECT_GT(truth.collisions, 10);
  EXPECT_LT(truth.worst, 2e-3);
  EXPECT_GT(truth.compared, isLong() ? 30'000 : 3'000);
}

TEST(OpticalCrowd, AssignsNoWrongIdentityAfterBlackPictures) {
  const TruthComparison truth = runCrowd(0);
  EXPECT_EQ(truth.swapped, 0);
  EXPECT_EQ(truth.flipped, 0);
  EXPECT_GT(truth.tracker.dark, 30);
  // Released identities are assigned again, by motion alone.
  EXPECT_GE(truth.tracker.bindings, 20 + truth.tracker.unbindings - 2);
  EXPECT_LE(truth.tracker.unbound, 2);
}

}  // namespace
}  // namespace lab::system_test
