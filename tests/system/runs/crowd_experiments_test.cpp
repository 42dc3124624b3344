// The shipped experiments of crowds show what their files say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <lab/collective_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "analyzer/collective/time_average.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::system_test::crowd_experiments_test {
namespace {

namespace fs = std::filesystem;
using collective::Average;
using collective::averageOf;

/// A virtual run without a report.
class CrowdExperiment : public testing::Test {
 protected:
  fs::path play(const std::string& name, const std::string& more = "") {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    const Finished lab = run("lab run " + experiment(name).string() +
                                 " --virtual-time --no-report --out " + out.string() + " " + more,
                             std::chrono::seconds(1500));
    EXPECT_EQ(lab.exit_code, 0) << lab.output;
    return onlyRun(out) / "log.lcmlog";
  }

 private:
  TemporaryFolder folder_;
  int runs_ = 0;
};

/// A number of all robots in the last frame, once a second.
std::vector<double> series(const fs::path& log, const std::string& name) {
  std::vector<double> values;
  readLog({log}, [&](const Packet& packet) {
    collective_t message{};
    if (packet.channel != channels::kCollective || !decode(packet.data, message)) return;
    if (message.program.hash != 0) return;
    for (const observable_t& one : message.observables) {
      if (one.name == name && std::isfinite(one.now)) values.push_back(one.now);
    }
  });
  return values;
}

/// The values from a share of the run on.
Average averageFrom(double share, const std::vector<double>& values) {
  const auto first = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  return averageOf(std::vector<double>(values.begin() + first, values.end()));
}

std::string text(const Average& average) {
  return std::to_string(average.value) + " (" + std::to_string(average.low) + " to " +
         std::to_string(average.high) + ")";
}

TEST_F(CrowdExperiment, DensityIsHeldAtItsTarget) {
  constexpr double kTarget = 0.3;
  constexpr std::size_t kShown = 120;  // [s]

  const std::vector<double> share = series(play("density_control"), "share_in_left");

  ASSERT_GT(share.size(), 1100U);
  for (std::size_t begin = 0; begin + kShown <= share.size(); begin += kShown) {
    const auto first = share.begin() + static_cast<std::ptrdiff_t>(begin);
    std::printf("share in the left half, %4zu to %4zu s: %.3f\n", begin, begin + kShown,
                std::accumulate(first, first + kShown, 0.0) / kShown);
  }
  const Average held = averageFrom(0.5, share);
  std::printf("last half: %s\n", text(held).c_str());
  EXPECT_LE(held.low, kTarget);
  EXPECT_GE(held.high, kTarget);
  EXPECT_LT(held.high, 0.45);
  // At the beginning there are as many as on the right, with a standard deviation of 0.09.
  EXPECT_GT(share.front(), 0.3);
}

TEST_F(CrowdExperiment, DensityIsNotHeldWithoutTheRule) {
  const std::vector<double> share = series(
      play("density_control", "--set light.steps[0].layers[1].crowd.gain=0"), "share_in_left");

  const Average free = averageFrom(0.25, share);
  std::printf("without the rule: %s\n", text(free).c_str());
  EXPECT_GT(free.value, 0.4);
}

TEST_F(CrowdExperiment, PersistentRobotsFormLargerClusters) {
  const std::string shorter = "--set duration_s=400";
  const auto slow = averageFrom(0.5, series(play("clustering", shorter), "mean_cluster"));
  const auto fast = averageFrom(
      0.5, series(play("clustering", shorter + " --set programs.abp.eta_rad_s=3"), "mean_cluster"));

  std::printf("mean cluster at eta = 1 rad/s: %s, at 3 rad/s: %s\n", text(slow).c_str(),
              text(fast).c_str());
  EXPECT_GT(slow.value, 2 * fast.value);
  EXPECT_LT(fast.high, 6);
}

TEST_F(CrowdExperiment, TheFlockEndsTheStep) {
  std::string ended_by;
  const fs::path log = play("flock");
  readLog({log}, [&](const Packet& packet) {
    experiment_event_t event{};
    if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
    if (event.kind == experiment_event_t::STEP && event.step == 1) ended_by = event.ended_by;
  });

  EXPECT_THAT(ended_by, testing::HasSubstr("polar_order"));
  EXPECT_LT(series(log, "polar_order").size(), 300U);
}

TEST_F(CrowdExperiment, RobotsFlockBecauseTheySenseTheirNeighbours) {
  const std::string on = "--set light.steps[0].until.above=0.9999 ";
  const auto flock = averageFrom(0.25, series(play("flock", on), "polar_order"));
  // Nobody is within 1 cm.
  const auto blind = averageFrom(
      0.25, series(play("flock", on + "--set senses.values[0].radius_cm=1"), "polar_order"));

  std::printf("polar order with senses: %s, without: %s\n", text(flock).c_str(),
              text(blind).c_str());
  EXPECT_GT(flock.value, 0.8);
  EXPECT_LT(blind.value, 0.4);
}

TEST_F(CrowdExperiment, TheQuorumGathersRobots) {
  const auto quorum = averageFrom(0.5, series(play("quorum_light"), "mean_cluster"));
  const auto uniform = averageFrom(
      0.5,
      series(play("quorum_light", "--set light.steps[0].layers[1].intensity=0.8"), "mean_cluster"));

  std::printf("mean cluster with the quorum: %s, in uniform light: %s\n", text(quorum).c_str(),
              text(uniform).c_str());
  ASSERT_TRUE(std::isfinite(uniform.high));
  EXPECT_GT(quorum.value, 1.5 * uniform.high);
}

}  // namespace
}  // namespace lab::system_test::crowd_experiments_test
