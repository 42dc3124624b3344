// Runs of programs of motion in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <map>
#include <set>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;

class ProgramsRun : public testing::Test {
 protected:
  fs::path labRun(const std::string& file, const std::string& more) {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    const Finished lab =
        run("lab run " + file + " --virtual-time --out " + out.string() + " " + more);
    EXPECT_EQ(lab.exit_code, 0) << lab.output;
    return onlyRun(out);
  }

  TemporaryFolder folder_;
  int runs_ = 0;
};

TEST_F(ProgramsRun, VirtualSensesComeWithTheDelayOfTheFileWithinOneFrame) {
  const fs::path directory =
      labRun(experiment("quorum_sensing").string(), "--set duration_s=20 --no-report");
  constexpr double kDelay = 0.5;       // s, of the file
  constexpr double kFrame = 1.0 / 25;  // s
  std::int64_t values = 0;
  std::set<std::int32_t> robots;
  readLog({directory / "log.lcmlog"}, [&](const Packet& packet) {
    robot_status_t status{};
    if (packet.channel != channels::kRobotStatus || !decode(packet.data, status)) return;
    for (const robot_state_t& state : status.robots) {
      if (state.senses_utime == 0) continue;
      const double delay =
          static_cast<double>(state.senses_since_utime - state.senses_utime) * 1e-6;
      EXPECT_NEAR(delay, kDelay, kFrame);
      robots.insert(state.robot_id);
      ++values;
    }
  });
  EXPECT_EQ(robots.size(), 20U);
  EXPECT_GT(values, 1000);
}

TEST_F(ProgramsRun, TheReportSaysTheDelayOfTheSensesThatWasAchieved) {
  const fs::path directory = labRun(experiment("quorum_sensing").string(),
                                    "--set duration_s=20 --set senses.delay_ms=200");
  const auto summary = readJson(directory / "summary.json");
  const auto senses = summary.at("virtual_senses");
  EXPECT_NEAR(senses.at("p50_ms").get<double>(), 200, 40);
  EXPECT_GT(senses.at("values").get<int>(), 1000);
  ASSERT_EQ(summary.at("sense_values").size(), 1U);
  const auto neighbours = summary.at("sense_values").at(0);
  EXPECT_EQ(neighbours.at("sense"), 0);
  EXPECT_EQ(neighbours.at("what"), "neighbours within 20 cm");
  EXPECT_GT(neighbours.at("mean").get<double>(), 0.1);
  EXPECT_LE(neighbours.at("highest").get<double>(), 19);
}

TEST_F(ProgramsRun, AProgramInTheExperimentFileIsExecutedBySimulatorAndWireAlike) {
  const fs::path file = folder_.path() / "own.toml";
  support::writeFile(file, R"(
fileversion = 1
name = "own"
duration_s = 20
program = "zigzag"
[[robots]]
id = 1
x_cm = 30
y_cm = 30
theta_deg = 0
[[robots]]
id = 2
body = "wire"
x_cm = 30
y_cm = 60
theta_deg = 0
[programs.zigzag.phases.left]
forward = "3 cm/s"
turn = "0.5 rad/s"
hold = "0.8 s"
next = "right"
[programs.zigzag.phases.right]
forward = "3 cm/s"
turn = "-0.5 rad/s"
hold = "0.8 s"
next = "left"
)");
  const fs::path directory = labRun(file.string(), "--no-report");
  std::map<std::int32_t, std::set<std::pair<int, long>>> seen;  // phase, wheel speed in um/s
  std::set<std::int32_t> named;
  readLog({directory / "log.lcmlog"}, [&](const Packet& packet) {
    robot_status_t status{};
    if (packet.channel == channels::kRobotStatus && decode(packet.data, status)) {
      for (const robot_state_t& state : status.robots) {
        if (state.program.name != "zigzag") continue;
        named.insert(state.robot_id);
        // A robot on the wire reports its phase more often than the speeds of its program.
        if (state.robot_id == 1) {
          seen[1].emplace(state.phase, std::lround(state.program_left * 1e6));
        }
      }
    }
    robot_steps_t steps{};
    if (packet.channel == channels::kRobotSteps && decode(packet.data, steps)) {
      for (const robot_step_t& step : steps.steps) {
        if (step.slot < 0) continue;
        seen[step.robot_id].emplace(step.phase, std::lround(step.wheel_left * 1e6));
      }
    }
  });
  const std::set<std::pair<int, long>> expected{{0, 30000 - 18750}, {1, 30000 + 18750}};
  EXPECT_EQ(seen[1], expected);
  EXPECT_EQ(seen[2], expected);
  EXPECT_THAT(named, testing::ElementsAre(1, 2));
}

}  // namespace
}  // namespace lab::system_test
