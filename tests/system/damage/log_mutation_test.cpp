// Whatever a log holds, its analysis ends: with a report, or with one line. Its replay ends, too.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report_error.hpp"
#include "runner/commands/log_events.hpp"
#include "runner/commands/log_playback.hpp"
#include "tests/system/damage/recorded_run.hpp"

namespace lab::damage {
namespace {

/// @return whether there is a report
bool analyze(const std::filesystem::path& log, const std::filesystem::path& out,
             analysis::Depth depth) {
  report::AnalyzeOptions options;
  options.figures = false;
  options.depth = depth;
  try {
    return !report::analyzeRun(log, out, options).headline.empty();
  } catch (const report::ReportError& refusal) {
    EXPECT_FALSE(std::string(refusal.what()).empty());
    return false;
  }
}

/// Replays to the end, ten times as fast as it was recorded, with a clock that does not wait.
void replay(const std::filesystem::path& log) {
  constexpr std::int64_t kStep_us = 500'000;
  constexpr double kSpeed = 10;
  constexpr int kMostSteps = 10'000;  // 5000 s at the terminal, for a run of 6 s
  try {
    runner::LogEvents events({log});
    if (events.all().empty()) return;
    std::int64_t now = 0;
    runner::LogPlayback playback(events, "run", kSpeed, runner::AtEnd::kEnd, now);
    int steps = 0;
    for (; steps < kMostSteps && !playback.over(); ++steps) {
      now += kStep_us;
      static_cast<void>(playback.advance(now));
      playback.play(now, [](std::string_view channel, Bytes message) {
        static_cast<void>(runner::asReplay(channel, message));
      });
      static_cast<void>(playback.status(now));
    }
    EXPECT_TRUE(playback.over()) << "after " << steps << " steps of " << playback.length() << " s";
    EXPECT_EQ(playback.sent(), events.all().size());
  } catch (const report::ReportError& refusal) {
    EXPECT_FALSE(std::string(refusal.what()).empty());
  }
}

// A crash or a hang names its mutant: LAB_MUTANT=seed LAB_MUTANTS=1 repeats it.
TEST(LogMutation, EveryDamagedLogIsAnalyzedAndReplayedOrRefused) {
  const std::vector<RecordedMessage>& whole = recordedRun();
  ASSERT_GT(whole.size(), 500U);
  const MutantRange range = mutants(200);
  const TemporaryFolder folder;
  const std::uint64_t analyzed = forEachMutant(range, [&](std::uint64_t seed) {
    SCOPED_TRACE(seed);
    const std::filesystem::path own = folder.path() / std::to_string(::getpid());
    std::filesystem::create_directories(own);
    const std::filesystem::path log = own / "log.lcmlog";
    std::ofstream(log, std::ios::binary) << logBytes(mutated(whole, seed), seed);
    replay(log);
    const auto depth = seed % 4 == 0 ? analysis::Depth::kFull : analysis::Depth::kLive;
    return analyze(log, own / "out", depth);
  });
  EXPECT_GE(10 * analyzed, 8 * range.count);
}

}  // namespace
}  // namespace lab::damage
