// Robots of every kind of body that needs no hardware, in one lab.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/experiment/experiment.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

using std::chrono::seconds;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr const char* kStalled = "sim_svc: stalled";

class MixedBodies : public testing::Test {
 protected:
  MixedBodies() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  /// A run without a stall of the simulator, if one of three attempts has none.
  fs::path labRun(const std::string& file, const std::string& more) {
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
      const fs::path out = folder.path() / std::to_string(++runs_);
      const Finished lab =
          run("lab run " + file + " --out " + out.string() + " " + more, seconds(900));
      EXPECT_EQ(lab.exit_code, 0) << lab.output;
      const bool stalled = lab.output.find(kStalled) != std::string::npos;
      if (stalled && attempt < kAttempts) continue;
      expectNoFault(lab.output, stalled);
      return onlyRun(out);
    }
  }

  /// A machine that does not give the simulator its time, which it says, is no fault of the lab;
  /// then its heartbeats and the answers of robots on lines are late.
  static void expectNoFault(const std::string& output, bool stalled) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("fault    ")) continue;
      const bool late = std::ranges::any_of(
          std::array{kStalled, "does not answer", "sim_svc has sent no heartbeat for",
                     "robots that did not confirm their light table"},
          [&line](const char* text) { return line.find(text) != std::string::npos; });
      EXPECT_TRUE(stalled && late) << output;
    }
  }

  /// Waits until the script begins: every robot has its light table.
  static bool waitUntilAllRun(Background& lab) {
    return waitUntil([&] { return lab.output().find("light half dark") != std::string::npos; },
                     seconds(60));
  }

  static bool alive(pid_t process) { return kill(process, 0) == 0; }

  TemporaryFolder folder;

 private:
  int runs_ = 0;
};

const std::string kMixed = experiment("mixed_bodies").string();

/// What the log contains about each robot.
struct Record {
  std::map<std::int32_t, std::set<std::string>> owners;
  std::map<std::int32_t, std::set<int>> origins;
  std::map<std::int32_t, std::set<std::int64_t>> uids;
  std::map<std::int32_t, double> last_left;
  std::map<std::int32_t, int> moving;  ///< status reports with turning wheels
  std::map<std::int32_t, int> frames;
  std::map<std::int32_t, int> steps;
};

Record recordOf(const fs::path& directory) {
  Record record;
  readLog({directory / "log.lcmlog"}, [&record](const Packet& packet) {
    robot_status_t status{};
    tracked_frame_t frame{};
    robot_steps_t steps{};
    if (packet.channel == channels::kRobotStatus && decode(packet.data, status)) {
      for (const robot_state_t& robot : status.robots) {
        record.owners[robot.robot_id].insert(status.sender);
        record.origins[robot.robot_id].insert(robot.origin);
        record.uids[robot.robot_id].insert(robot.uid);
        record.moving[robot.robot_id] += robot.wheel_left != 0 || robot.wheel_right != 0 ? 1 : 0;
      }
    }
    if (packet.channel == channels::kTrackedFrame && decode(packet.data, frame)) {
      for (const tracked_pose_t& pose : frame.robots) ++record.frames[pose.robot_id];
    }
    if (packet.channel == channels::kRobotSteps && decode(packet.data, steps)) {
      for (const robot_step_t& step : steps.steps) ++record.steps[step.robot_id];
    }
  });
  return record;
}

void expectNothingLost(const fs::path& directory) {
  const auto summary = readJson(directory / "summary.json");
  for (const auto& stream : summary.at("losses").at("log")) {
    EXPECT_EQ(stream.at("lost"), 0) << stream;
  }
}

TEST_F(MixedBodies, ShareOneArenaInVirtualTimeBitIdentically) {
  const std::string more = "--virtual-time --set duration_s=20";
  const fs::path a = labRun(kMixed, more);
  const fs::path b = labRun(kMixed, more);
  for (const char* file : {"log.lcmlog", "summary.json", "trajectories.csv"}) {
    EXPECT_TRUE(readFile(a / file) == readFile(b / file)) << file;
  }
  expectNothingLost(a);
  const Record record = recordOf(a);
  ASSERT_EQ(record.owners.size(), 20U);
  int on_wire = 0;
  for (const auto& [id, owners] : record.owners) {
    ASSERT_EQ(owners.size(), 1U) << id;
    const bool wire = *owners.begin() == "robot_bridge";
    on_wire += wire ? 1 : 0;
    EXPECT_EQ(record.origins.at(id), std::set<int>{robot_state_t::SIM}) << id;
    const std::int64_t uid = wire ? simulatedUid(id) : 0;
    EXPECT_EQ(record.uids.at(id), std::set<std::int64_t>{uid}) << id;
    EXPECT_GT(record.moving.at(id), 100) << id;
    EXPECT_GT(record.frames.at(id), 300) << id;
    EXPECT_EQ(record.steps.contains(id), wire) << id;
  }
  EXPECT_EQ(on_wire, 2);
}

TEST_F(MixedBodies, RunLiveWithoutLossesAndWithoutOrphans) {
  const fs::path directory = labRun(kMixed, "--set duration_s=15");
  expectNothingLost(directory);
  const Record record = recordOf(directory);
  EXPECT_EQ(record.owners.size(), 20U);
  for (const auto& [id, moving] : record.moving) EXPECT_GT(moving, 50) << id;
  EXPECT_THAT(processesWith(folder.path().string()), IsEmpty());
}

TEST_F(MixedBodies, AStopReachesEveryBody) {
  Background lab("exec lab run " + kMixed + " --no-report --set duration_s=20 --out " +
                 (folder.path() / "live").string());
  ASSERT_TRUE(waitUntilAllRun(lab)) << lab.output();
  const Finished stop = run("lab stop");
  EXPECT_EQ(stop.exit_code, 0) << stop.output;
  EXPECT_THAT(stop.output, HasSubstr("confirmed by 20 robots"));
  lab.signal(SIGINT);
  lab.wait(seconds(180));
}

TEST_F(MixedBodies, AKilledChipIsRestartedAndStands) {
  Background lab("exec lab run " + kMixed + " --no-report --set duration_s=12 --out " +
                 (folder.path() / "live").string());
  ASSERT_TRUE(waitUntilAllRun(lab)) << lab.output();
  const auto simulators = childrenWith(lab.pid(), "/sim_svc");
  ASSERT_EQ(simulators.size(), 1U);
  const auto emulators = childrenWith(simulators.front(), "robot_emulator");
  ASSERT_EQ(emulators.size(), 1U);
  kill(emulators.front(), SIGKILL);
  const Finished ended = lab.wait(seconds(180));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("robot_emulator"));
  EXPECT_THAT(ended.output, HasSubstr("robot 1: restarted; it stands"));
  EXPECT_FALSE(alive(emulators.front()));
  EXPECT_THAT(processesWith(folder.path().string()), IsEmpty());
}

TEST_F(MixedBodies, AReplayRobotRepeatsItsRecording) {
  const fs::path recorded = labRun(kMixed, "--virtual-time --no-report --set duration_s=20");
  const fs::path file = folder.path() / "replayed.toml";
  std::ofstream(file)
      << "fileversion = 1\nname = \"replayed\"\nduration_s = 10\nprogram = \"abp\"\n"
         "[[robots]]\nid = 1\n[[robots]]\nid = 7\nbody = \"replay\"\nlog = \""
      << recorded.string()
      << "\"\nrecorded_id = 1\n[programs.abp]\nmodel = \"abp\"\nv_cm_s = 3\n"
         "epsilon_s = 0.5\neta_rad_s = 3\n";
  const fs::path replayed = labRun(file.string(), "--virtual-time");
  const Record record = recordOf(replayed);
  EXPECT_EQ(record.origins.at(7), std::set<int>{robot_state_t::REPLAY});
  EXPECT_EQ(record.origins.at(1), std::set<int>{robot_state_t::SIM});
  EXPECT_GT(record.frames.at(7), 200);
}

}  // namespace
}  // namespace lab::system_test
