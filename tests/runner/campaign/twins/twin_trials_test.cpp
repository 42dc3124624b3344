#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/math/random.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/twins/twin_comparison.hpp"

namespace lab::runner::campaign::twin_trials_test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTwins = 40;

constexpr const char* kSingle = R"(fileversion = 1
name = "single"
duration_s = 40
program = "abp"
[[robots]]
id = 1
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.2
eta_rad_s = 5
[camera]
fps = 20
position_noise_cm = 0.03
heading_noise_deg = 0.6
frame_loss = 0.02
)";

constexpr const char* kCrowd = R"(fileversion = 1
name = "crowd"
duration_s = 20
program = "rtp"
robots = [{id = 1}, {id = 2}, {id = 3}, {id = 4}, {id = 5}, {id = 6}, {id = 7}, {id = 8}]
[arena]
width_cm = 60
height_cm = 60
[programs.rtp]
model = "rtp"
v_cm_s = 5
[reversal]
on = "never"
[camera]
fps = 10
position_noise_cm = 0.03
heading_noise_deg = 0.6
)";

/// Summaries of runs with different seeds. @return without those that failed
std::vector<std::string> simulated(const char* text, const std::vector<std::string>& set,
                                   std::int64_t runs, std::uint64_t seed) {
  const fs::path folder = fs::path(testing::TempDir()) / "twin trials";
  fs::remove_all(folder);
  fs::create_directories(folder);
  Request request;
  request.name = "trials";
  request.file = (folder / "trials.toml").string();
  request.set = set;
  request.seeds = runs;
  request.seed = seed;
  replaceFile(request.file, text);
  Plan plan = planCampaign(request, text);
  writeCampaign(folder, {request, "now", text, std::move(plan.points)}, plan.files);
  CampaignData data = dataOf(readCampaign(folder));
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < data.rows.size(); ++i) rows.push_back(i);
  static_cast<void>(
      runLocally(data, folder, rows, {.jobs = std::max(1U, std::thread::hardware_concurrency())}));
  std::vector<std::string> summaries;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (data.survey.rows[i].kind != RowState::Kind::kDone) continue;
    summaries.push_back(
        readFileText(folder / summaryFile(data.rows[i].identity), file_kinds::kText));
  }
  fs::remove_all(folder);
  return summaries;
}

/// Trials: one of `runs` beside random ones of the pool. @return the number with p < 0.01
struct Trials {
  int trials = 0;
  int below_1 = 0;
  int below_5 = 0;
  std::size_t looks = 0;
};
Trials trialsOf(const std::vector<std::string>& runs, const std::vector<std::string>& pool,
                int trials, bool same) {
  Random random(3);
  std::vector<std::string> ordered = pool;
  Trials result;
  for (int trial = 0; trial < trials; ++trial) {
    for (std::size_t i = 0; i <= kTwins; ++i) {
      const auto other =
          i + static_cast<std::size_t>(random.uniform() * static_cast<double>(ordered.size() - i));
      std::swap(ordered[i], ordered[std::min(other, ordered.size() - 1)]);
    }
    const std::string& run =
        same ? ordered[kTwins] : runs[static_cast<std::size_t>(trial) % runs.size()];
    const TwinComparison comparison = compareWithTwins(
        looksOf(run, {ordered.begin(), ordered.begin() + static_cast<std::ptrdiff_t>(kTwins)}));
    ++result.trials;
    if (comparison.p < 0.01) ++result.below_1;
    if (comparison.p < 0.05) ++result.below_5;
    result.looks = comparison.looks.size();
  }
  return result;
}

void expectFewFalseAlarms(const char* text, std::int64_t runs) {
  const std::vector<std::string> pool = simulated(text, {}, runs, 1);
  ASSERT_EQ(pool.size(), static_cast<std::size_t>(runs));
  const Trials trials = trialsOf({}, pool, 1000, true);
  std::printf("%zu looks; p < 0.01 in %d, p < 0.05 in %d of %d trials\n", trials.looks,
              trials.below_1, trials.below_5, trials.trials);

  // 1 % and two standard errors: the trials share the runs of the pool.
  const double sigma = std::sqrt(0.01 / static_cast<double>(std::min<std::int64_t>(runs, 1000)));
  EXPECT_LE(trials.below_1, (0.01 + 2 * sigma) * trials.trials);
  EXPECT_GE(trials.below_5, 5);
}

TEST(TwinTrials, OneRobotHasFalseAlarmsInOnePercentAtMost) { expectFewFalseAlarms(kSingle, 2000); }

TEST(TwinTrials, ACrowdHasFalseAlarmsInOnePercentAtMost) { expectFewFalseAlarms(kCrowd, 1000); }

TEST(TwinTrials, AParameterOffByFivePercentIsFound) {
  const std::vector<std::string> pool = simulated(kSingle, {}, 400, 1);
  for (const auto& [key, least] :
       std::vector<std::pair<std::string, double>>{{"v_cm_s=3.15", 0.99}, {"eta_rad_s=5.25", 0}}) {
    const std::vector<std::string> runs = simulated(kSingle, {"programs.abp." + key}, 100, 2);
    const Trials trials = trialsOf(runs, pool, 200, false);
    std::printf("%s: found in %d of %d\n", key.c_str(), trials.below_1, trials.trials);
    EXPECT_GE(trials.below_1, least * trials.trials) << key;
  }
}

}  // namespace
}  // namespace lab::runner::campaign::twin_trials_test
