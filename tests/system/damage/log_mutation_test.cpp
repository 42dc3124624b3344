// Whatever a log holds, its analysis ends: with a report, or with one line.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report_error.hpp"
#include "tests/system/damage/recorded_run.hpp"

namespace lab::damage {
namespace {

// A crash or a hang names its mutant: LAB_MUTANT=seed LAB_MUTANTS=1 repeats it.
TEST(LogMutation, EveryDamagedLogIsAnalyzedOrRefused) {
  const std::vector<RecordedMessage>& whole = recordedRun();
  ASSERT_GT(whole.size(), 500U);
  const MutantRange range = mutants(200);
  std::size_t analyzed = 0;
  const TemporaryFolder folder;
  for (std::uint64_t seed = range.first; seed < range.first + range.count; ++seed) {
    const MutantWatch watch(seed);
    const std::filesystem::path log = folder.path() / "log.lcmlog";
    std::ofstream(log, std::ios::binary) << logBytes(mutated(whole, seed), seed);
    report::AnalyzeOptions options;
    options.figures = false;
    options.depth = seed % 4 == 0 ? analysis::Depth::kFull : analysis::Depth::kLive;
    try {
      const report::AnalyzedRun run = report::analyzeRun(log, folder.path() / "out", options);
      analyzed += run.headline.empty() ? 0U : 1U;
    } catch (const report::ReportError& refusal) {
      EXPECT_FALSE(std::string(refusal.what()).empty()) << "mutant " << seed;
    }
  }
  EXPECT_GE(10 * analyzed, 8 * range.count);
}

}  // namespace
}  // namespace lab::damage
