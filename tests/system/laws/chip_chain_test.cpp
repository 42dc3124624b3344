// The whole chain against the exact laws: the firmware binary on simulated chips, PWM, arena,
// tracker frames, serial lines, bridge, log and analysis. One program per run, in virtual time.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/lab_process.hpp"
#include "tests/system/laws/run_against_law.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

/// Minutes in the CI tier, hours in the long tier.
RunSize sizeOfRun() {
  if (std::getenv("LAB_LONG") != nullptr) return {8, 3600, 600};
  return {};
}

fs::path writeExperimentFile(const fs::path& folder, const Chain& chain, const RunSize& size) {
  const double fps = readReferenceSet(chain.table).fps;
  const fs::path file = folder / "chain.toml";
  std::ofstream(file) << "fileversion = 1\nname = \"chain\"\nseed = 5\nduration_s = "
                      << size.duration + 5
                      << "\nprogram = \"dut\"\n"
                         "[arena]\nwidth_cm = 1000\nheight_cm = 1000\n"
                         "[[robots]]\nid = 1\nbody = \"firmware\"\ncount = "
                      << size.robots << "\n[reversal]\non = \"any\"\n[programs.dut]\n"
                      << chain.program << "[camera]\nfps = " << fps << "\n";
  return file;
}

class ChipChain : public testing::TestWithParam<Chain> {};

TEST_P(ChipChain, AgreesWithTheExactLaw) {
  const RunSize size = sizeOfRun();
  const TemporaryFolder folder;
  const fs::path file = writeExperimentFile(folder.path(), GetParam(), size);
  const Finished lab = run("lab run " + file.string() + " --virtual-time --no-report --out " +
                               (folder.path() / "runs").string(),
                           std::chrono::hours(1));
  ASSERT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output, testing::Not(testing::HasSubstr("fault    "))) << lab.output;

  const Measured measured = measure(onlyRun(folder.path() / "runs"), GetParam().table, size);
  const double recordings = expectLaw(measured, GetParam().table, size.film);
  EXPECT_GE(recordings, 0.8 * size.robots * size.duration / size.film) << "recordings";
}

INSTANTIATE_TEST_SUITE_P(Programs, ChipChain,
                         testing::Values(kAbpChain, kNoisyAbpChain, kBpChain, kRtpChain),
                         [](const auto& chain) { return testName(chain.param.table); });

}  // namespace
}  // namespace lab::system_test
