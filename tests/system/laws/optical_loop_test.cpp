// The optical loop against the exact laws: robots, painted frames, detector, identities by
// handshake, log and analysis. One program per run, in virtual time.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>

#include "tests/support/lab_process.hpp"
#include "tests/system/laws/run_against_law.hpp"
#include "tests/system/runs/truth_comparison.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

/// Because of walls and reversals a recording has fewer windows than frames.
const RunSize kSize{3, 600, 120, 0.6};

/// Every frame of the table in the long tier; at least ten per second in the CI tier.
int thinning(double fps) {
  constexpr double kRate = 10;  // [1/s]
  if (std::getenv("LAB_LONG") != nullptr) return 1;
  return std::max(1, static_cast<int>(std::floor(fps / kRate)));
}

fs::path writeExperimentFile(const fs::path& folder, const Chain& chain, int thinned) {
  const fs::path file = folder / "loop.toml";
  std::ofstream(file) << "fileversion = 1\nname = \"loop\"\nseed = 3\nduration_s = "
                      << kSize.duration + 5
                      << "\nprogram = \"dut\"\n"
                         "[robot]\nclock_error_percent = 0\n"
                         "[[robots]]\nid = 1\ncount = "
                      << kSize.robots
                      << "\n[reversal]\non = \"any\"\ndistance_cm = 15\n[programs.dut]\n"
                      << chain.program << "[camera]\ntracker = \"camera\"\ncamera = \"sim\"\nfps = "
                      << readReferenceSet(chain.table).fps / thinned << "\n";
  return file;
}

class OpticalLoop : public testing::TestWithParam<Chain> {};

TEST_P(OpticalLoop, AgreesWithTheExactLaw) {
  const int thinned = thinning(readReferenceSet(GetParam().table).fps);
  const TemporaryFolder folder;
  const fs::path file = writeExperimentFile(folder.path(), GetParam(), thinned);
  const Finished lab = run("lab run " + file.string() + " --virtual-time --no-report --out " +
                               (folder.path() / "runs").string(),
                           std::chrono::hours(1));
  ASSERT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, testing::Not(testing::HasSubstr("fault    "))) << lab.output;

  const fs::path run_folder = onlyRun(folder.path() / "runs");
  const TruthComparison truth = compareWithTruth(run_folder);
  std::cout << truth.compared << " poses against the truth: worst " << truth.worst * 1e3 << " mm, "
            << truth.worst_turn * 180 / std::numbers::pi << " degrees; " << truth.collisions
            << " collisions; spacing error " << truth.tracker.spacing_error * 1e6 << " um\n";
  EXPECT_GT(truth.compared, 1000);  // poses at the times of the truth
  EXPECT_EQ(truth.swapped, 0);
  EXPECT_EQ(truth.flipped, 0);
  EXPECT_LT(truth.worst, 1e-3);
  EXPECT_LT(truth.worst_turn, 0.02);
  EXPECT_EQ(truth.tracker.bindings, kSize.robots);
  EXPECT_EQ(truth.tracker.unbindings, 0);
  EXPECT_EQ(truth.tracker.flips, 0);
  EXPECT_EQ(truth.tracker.moved, 0) << truth.tracker.warning;

  const Measured measured = measure(run_folder, GetParam().table, kSize, thinned);
  const double recordings = expectLaw(measured, GetParam().table, kSize.film);
  EXPECT_GE(recordings, 0.8 * kSize.robots * kSize.duration / kSize.film) << "recordings";
}

INSTANTIATE_TEST_SUITE_P(ABP, OpticalLoop, testing::Values(kAbpChain));
INSTANTIATE_TEST_SUITE_P(NABP, OpticalLoop, testing::Values(kNoisyAbpChain));
INSTANTIATE_TEST_SUITE_P(BP, OpticalLoop, testing::Values(kBpChain));
INSTANTIATE_TEST_SUITE_P(RTP, OpticalLoop, testing::Values(kRtpChain));

}  // namespace
}  // namespace lab::system_test
