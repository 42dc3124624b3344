// Damaged logs that once crashed the analysis, or kept it or the replay busy for minutes or years.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report_error.hpp"
#include "runner/commands/log_events.hpp"
#include "tests/support/mutated_log.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::damage {
namespace {

namespace fs = std::filesystem;

class DamagedLog : public testing::TestWithParam<const char*> {
 protected:
  DamagedLog() {
    const std::string command = "xz -dc '" LAB_DAMAGED_LOGS "/" + std::string(GetParam()) +
                                ".lcmlog.xz' > '" + log_.string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
  }

  TemporaryFolder folder_;
  fs::path log_ = folder_.path() / "log.lcmlog";
};

TEST_P(DamagedLog, IsAnalyzedOrRefused) {
  const MutantWatch watch(0);
  try {
    const report::AnalyzedRun run =
        report::analyzeRun(log_, folder_.path() / "out", {.figures = false});
    EXPECT_FALSE(run.headline.empty());
  } catch (const report::ReportError& refusal) {
    EXPECT_NE(std::string(refusal.what()), "");
  }
}

TEST_P(DamagedLog, IsReplayedWithinItsOwnTime) {
  const runner::LogEvents dut({log_});

  ASSERT_FALSE(dut.all().empty());
  EXPECT_LT(dut.all().back().utime - dut.all().front().utime, 120'000'000);
}

INSTANTIATE_TEST_SUITE_P(All, DamagedLog,
                         testing::Values("analyze_crash_1", "analyze_crash_2", "analyze_hang_1",
                                         "replay_gap_1", "replay_gap_2", "two_bits"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace lab::damage
