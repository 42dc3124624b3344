#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/analysis_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <stdexcept>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

/// Records a short run.
class Replay : public testing::Test {
 protected:
  Replay() {
    setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
    const Finished lab = run("lab run " + experiment("light_switching").string() +
                             " --virtual-time --no-report --set analysis.results_every_s=1 --out " +
                             (folder.path() / "runs").string());
    if (lab.exit_code != 0) throw std::runtime_error(lab.output);
    log = onlyRun(folder.path() / "runs") / "log.lcmlog";
  }

  TemporaryFolder folder;
  fs::path log;
};

/// The last ANALYSIS of every program and robot, from the analyzer in virtual time (instance 1) or
/// from the other one.
std::map<std::pair<std::string, int>, analysis_t> lastAnalyses(const fs::path& log,
                                                               bool virtual_time) {
  std::map<std::pair<std::string, int>, analysis_t> last;
  readLog({log}, [&](const Packet& packet) {
    analysis_t analysis{};
    if (packet.channel != channels::kAnalysis || !decode(packet.data, analysis)) return;
    if ((analysis.instance == 1) != virtual_time) return;
    last[{analysis.program.name, analysis.robot_id}] = analysis;
  });
  return last;
}

/// The time of the last camera frame [us since 1970].
std::int64_t lastFrame(const fs::path& log) {
  std::int64_t last = 0;
  readLog({log}, [&last](const Packet& packet) {
    tracked_frame_t frame{};
    if (packet.channel == channels::kTrackedFrame && decode(packet.data, frame)) last = frame.utime;
  });
  return last;
}

TEST_F(Replay, AnAnalyzerFedByLcmLogplayerGivesTheSameResults) {
  const std::string url = "'udpm://239.255.76.67:24681?ttl=0&recv_buf_size=4194304'";
  const fs::path again = folder.path() / "again.lcmlog";
  Background logger("exec lcm-logger -q --lcm-url=" + url + " " + again.string());
  // The programmed speeds depend on the motors, which the experiment describes.
  Background analyzer("exec analyzer --lcm-url " + url + " --experiment " +
                      (log.parent_path() / "experiment.toml").string());
  ASSERT_TRUE(
      waitUntil([&] { return fs::exists(again) && fs::file_size(again) > 0; }, seconds(60)));
  const Finished player = run("lcm-logplayer -s 15 -l " + url + " " + log.string());
  ASSERT_EQ(player.exit_code, 0) << player.output;
  const std::int64_t last_frame = lastFrame(log);
  EXPECT_TRUE(waitUntil(
      [&] {
        const auto results = lastAnalyses(again, false);
        return !results.empty() && std::ranges::all_of(results, [&](const auto& result) {
          return result.second.utime >= last_frame;
        });
      },
      seconds(60)))
      << "the analyzer has not analyzed the last frame";
  analyzer.signal(SIGTERM);
  EXPECT_EQ(analyzer.wait(seconds(60)).exit_code, 0);
  logger.signal(SIGTERM);
  logger.wait(seconds(60));

  const auto before = lastAnalyses(log, true);
  const auto after = lastAnalyses(again, false);
  ASSERT_EQ(before.size(), 21U) << "three programs: the pool and six robots";
  ASSERT_EQ(after.size(), before.size());
  int compared = 0;
  for (const auto& [key, expected] : before) {
    const analysis_t& found = after.at(key);
    if (expected.program.name == "rtp") {
      // It ran last: the run's last round came up to a second before its end, and half a second of
      // frames followed that. The pool has six robots.
      EXPECT_NEAR(found.observed, expected.observed, expected.robot_id < 0 ? 6 * 1.6 : 1.6);
      continue;
    }
    EXPECT_EQ(found.observed, expected.observed);
    ASSERT_EQ(found.estimates.size(), expected.estimates.size());
    for (std::size_t i = 0; i < expected.estimates.size(); ++i) {
      if (std::isnan(expected.estimates[i].value)) continue;
      ++compared;
      EXPECT_EQ(found.estimates[i].value, expected.estimates[i].value);
      EXPECT_EQ(found.estimates[i].sigma, expected.estimates[i].sigma);
    }
  }
  EXPECT_GE(compared, 14);
}

TEST_F(Replay, LabReplayPlaysAPartOnItsOwnBusAsReplay) {
  const fs::path recorded = folder.path() / "heard.lcmlog";
  Background player("exec lab replay " + log.string() +
                    " --from 10 --to 40 --speed 10 --port 24683 --channel ROBOT_STATUS");
  Background logger("exec lcm-logger -q '--lcm-url=udpm://239.255.76.67:24683?ttl=0' " +
                    recorded.string());
  const Finished ended = player.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  logger.signal(SIGTERM);
  logger.wait(seconds(60));
  int messages = 0;
  readLog({recorded}, [&messages](const Packet& packet) {
    // The state of the player is always published.
    if (packet.channel == channels::kExperimentStatus) return;
    EXPECT_EQ(packet.channel, channels::kRobotStatus);
    robot_status_t status{};
    ASSERT_TRUE(decode(packet.data, status));
    EXPECT_EQ(status.robots.at(0).origin, robot_state_t::REPLAY);
    ++messages;
  });
  // 30 s at 50 Hz, without the messages before the logger started.
  EXPECT_GT(messages, 1000);
  EXPECT_LE(messages, 1501);
}

}  // namespace
}  // namespace lab::system_test
