// Scripts with conditions: every kind of condition, and every `if_not` when it is not met.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

constexpr const char* kHead = R"(fileversion = 1
name = "waiting"
duration_s = 120
[[robots]]
id = 1
x_cm = 60
y_cm = 45
theta_deg = 0
[[robots]]
id = 2
x_cm = 60
y_cm = 65
theta_deg = 0
[robot]
clock_error_percent = 0
[programs.straight]
model = "wheels"
left_cm_s = 5
right_cm_s = 5
[programs.rtp]
model = "rtp"
v_cm_s = 5
gamma_per_s = 3
tau_t_s = 0.5
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.1
eta_rad_s = 5
[light_table]
bands = [
  {light = [0.1, 0.3], program = "straight"},
  {light = [0.4, 0.6], program = "rtp"},
  {light = [0.7, 0.9], program = "abp"},
]
[light]
safe_intensity = 0.05
)";

std::string step(const std::string& label, double light, const std::string& more) {
  return "[[light.steps]]\nlabel = \"" + label +
         "\"\nlayers = [{kind = \"uniform\", intensity = " + std::to_string(light) + "}]\n" + more +
         "\n";
}

class ConditionalScript : public testing::Test {
 protected:
  struct Run {
    Finished lab;
    fs::path directory;
    std::vector<experiment_event_t> steps;  ///< in order, the last record of each
    std::vector<std::string> faults;
    experiment_event_t end{};
  };

  Run play(const std::string& script, const std::string& more = "") {
    const fs::path file = folder_.path() / "waiting.toml";
    support::writeFile(file, kHead + script);
    const fs::path out = folder_.path() / std::to_string(++runs_);
    Run played;
    played.lab = run("lab run " + file.string() + " --virtual-time --no-report --out " +
                     out.string() + " " + more);
    played.directory = onlyRun(out);
    std::map<int, experiment_event_t> steps;
    std::set<std::string> faults;
    readLog({played.directory / "log.lcmlog"}, [&](const Packet& packet) {
      experiment_event_t event{};
      if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
      if (event.kind == experiment_event_t::STEP) steps[event.step] = event;
      if (event.kind == experiment_event_t::END) played.end = event;
      if (event.kind == experiment_event_t::FAULT) faults.insert(event.text);
    });
    for (const auto& [number, event] : steps) played.steps.push_back(event);
    played.faults.assign(faults.begin(), faults.end());
    return played;
  }

 private:
  TemporaryFolder folder_;
  int runs_ = 0;
};

/// Time in the script at which a step was commanded [s].
double begin(const experiment_event_t& step, const std::vector<experiment_event_t>& steps) {
  return static_cast<double>(step.commanded_utime - steps.front().commanded_utime) * 1e-6;
}

TEST_F(ConditionalScript, GoesOnWhenARobotIsInTheRegion) {
  const Run dut =
      play(step("go", 0.2,
                "hold_s = 20\nuntil = {robot = 1, region = \"circle\", x_cm = 85, y_cm = 45, "
                "radius_cm = 10}") +
           step("there", 0, "hold_s = 1"));
  EXPECT_EQ(dut.lab.exit_code, 0) << dut.lab.output;
  ASSERT_THAT(dut.steps, SizeIs(2));
  EXPECT_THAT(dut.steps[1].ended_by, StartsWith("robot 1 is in the circle of radius 10 cm around "
                                                "85, 45 cm; sample "));
  // 15 cm at 5 cm/s, plus the delays of light, sensor and camera.
  EXPECT_GT(begin(dut.steps[1], dut.steps), 3.0);
  EXPECT_LT(begin(dut.steps[1], dut.steps), 3.0 + 0.2);
  EXPECT_THAT(dut.faults, IsEmpty());
  EXPECT_EQ(dut.end.text, "the script is over");
}

TEST_F(ConditionalScript, CountsTheTumblesOfAllRobotsOnce) {
  const Run dut = play(step("tumble", 0.5, "hold_s = 60\nuntil = {tumbles = 30}") +
                       step("then", 0, "hold_s = 2"));
  EXPECT_EQ(dut.lab.exit_code, 0) << dut.lab.output;
  ASSERT_THAT(dut.steps, SizeIs(2));
  EXPECT_THAT(dut.steps[1].ended_by, StartsWith("30 tumbles; sample "));
  // The counters of both robots in the log when the next step was commanded.
  std::map<int, int> tumbles;
  readLog({dut.directory / "log.lcmlog"}, [&](const Packet& packet) {
    robot_status_t status{};
    if (packet.channel != channels::kRobotStatus || !decode(packet.data, status)) return;
    if (packet.received_utime > dut.steps[1].commanded_utime) return;
    for (const auto& robot : status.robots) tumbles[robot.robot_id] = robot.tumble_count;
  });
  EXPECT_THAT(tumbles[1] + tumbles[2], testing::AllOf(testing::Ge(30), testing::Le(31)));
}

TEST_F(ConditionalScript, EndsTheRunWhenTheLastStepsEstimateIsKnown) {
  const Run dut = play(
      step("measure", 0.8,
           "hold_s = 120\nuntil = {estimate = \"D_r\", program = \"abp\", relative_error = 0.2}"));
  EXPECT_EQ(dut.lab.exit_code, 0) << dut.lab.output;
  EXPECT_THAT(dut.faults, IsEmpty());
  EXPECT_THAT(dut.end.text, StartsWith("the script is over: D_r of abp is known to 20 %; sample "));
  EXPECT_LT(static_cast<double>(dut.end.utime - dut.steps.at(0).commanded_utime) * 1e-6, 119);
}

TEST_F(ConditionalScript, StopRulesEndTheRunAsSoonAsTheyHold) {
  const std::string rules =
      "[[stop_when]]\nestimate = \"D_r\"\nprogram = \"abp\"\nrelative_error_percent = 20\n"
      "[[stop_when]]\nestimate = \"v\"\nprogram = \"abp\"\nrelative_error_percent = 5\n"
      "at_least_s = 15\n";
  const Run dut = play(step("measure", 0.8, "at_s = 0") + rules);
  EXPECT_EQ(dut.lab.exit_code, 0) << dut.lab.output;
  EXPECT_THAT(dut.faults, IsEmpty());
  EXPECT_THAT(dut.end.text,
              StartsWith("stop_when: D_r of abp is known to 20 %: relative error 0."));
  EXPECT_THAT(dut.end.text, HasSubstr("; v of abp is known to 5 %: relative error 0."));
  const double length = static_cast<double>(dut.end.utime - dut.steps.at(0).commanded_utime) * 1e-6;
  EXPECT_GE(length, 15);
  EXPECT_LT(length, 119);
}

TEST_F(ConditionalScript, ARunWhoseStopRulesAreNotReachedIsMarked) {
  const Run dut = play(step("measure", 0.8, "at_s = 0") +
                           "[[stop_when]]\nestimate = \"D_r\"\nprogram = \"abp\"\n"
                           "relative_error_percent = 0.1\n",
                       "--set duration_s=20");
  EXPECT_EQ(dut.lab.exit_code, 3) << dut.lab.output;
  ASSERT_THAT(dut.faults, SizeIs(1));
  EXPECT_THAT(dut.faults[0],
              StartsWith("stop_when was not reached; D_r of abp is known to 0.1 %: relative "
                         "error 0."));
  EXPECT_EQ(dut.end.text, dut.faults[0]);
  EXPECT_THAT(dut.lab.output, HasSubstr("fault    stop_when was not reached"));
}

TEST_F(ConditionalScript, GoesOnAfterAnUnmetConditionAndReportsItsProgress) {
  const Run dut =
      play(step("measure", 0.8,
                "hold_s = 8\nuntil = {estimate = \"D_r\", program = \"abp\", relative_error = "
                "0.001}\nif_not = \"next\"") +
           step("then", 0, "hold_s = 2"));
  EXPECT_EQ(dut.lab.exit_code, 0) << dut.lab.output;
  ASSERT_THAT(dut.steps, SizeIs(2));
  EXPECT_EQ(begin(dut.steps[1], dut.steps), 8);
  EXPECT_THAT(dut.steps[1].ended_by, StartsWith("its limit of 8 s; relative error 0."));
  ASSERT_THAT(dut.faults, SizeIs(1));
  EXPECT_THAT(
      dut.faults[0],
      StartsWith("step 0 \"measure\": after 8 s its condition \"D_r of abp is known to 0.1 %\" "
                 "was not met: relative error 0."));
  EXPECT_THAT(dut.lab.output, HasSubstr("fault    step 0 \"measure\""));
}

TEST_F(ConditionalScript, EndsARunWithAnUnmetCondition) {
  const Run dut = play(step("tumble", 0.2, "hold_s = 4\nuntil = {tumbles = 1}\nif_not = \"end\"") +
                       step("then", 0, "hold_s = 2"));
  EXPECT_EQ(dut.lab.exit_code, 3) << dut.lab.output;
  EXPECT_THAT(dut.steps, SizeIs(1));
  EXPECT_THAT(dut.faults,
              ElementsAre("step 0 \"tumble\": after 4 s its condition \"a tumble\" was not "
                          "met: 0 tumbles, wanted 1; the run ends"));
  EXPECT_EQ(dut.end.text, dut.faults[0]);
}

TEST_F(ConditionalScript, ShowsTheSafeLightToStoppedRobotsBeforeItEnds) {
  const Run dut = play(step("all", 0.2,
                            "hold_s = 4\nuntil = {robots = \"all\", region = \"circle\", x_cm = "
                            "85, y_cm = 45, radius_cm = 12}\nif_not = \"safe\"") +
                       step("then", 0.5, "hold_s = 2"));
  EXPECT_EQ(dut.lab.exit_code, 3) << dut.lab.output;
  EXPECT_THAT(dut.steps, SizeIs(1));
  ASSERT_THAT(dut.faults, SizeIs(1));
  EXPECT_THAT(dut.faults[0], HasSubstr("at most 1 of 2 robots were there at the same time"));
  light_status_t light{};
  robot_status_t robots{};
  readLog({dut.directory / "log.lcmlog"}, [&](const Packet& packet) {
    if (packet.received_utime > dut.end.utime) return;
    if (packet.channel == channels::kLightStatus) {
      EXPECT_TRUE(decode(packet.data, light));
    }
    if (packet.channel == channels::kRobotStatus) {
      EXPECT_TRUE(decode(packet.data, robots));
    }
  });
  EXPECT_EQ(light.label, "safe");
  ASSERT_THAT(light.layers, SizeIs(1));
  EXPECT_EQ(light.layers[0].intensity, 0.05);
  for (const auto& robot : robots.robots) {
    EXPECT_EQ(robot.program.hash, 0) << robot.robot_id;
    EXPECT_EQ(robot.wheel_left, 0) << robot.robot_id;
  }
}

TEST_F(ConditionalScript, RepeatsAGroupBitIdentically) {
  const std::string script = step("tumble", 0.5, "hold_s = 30\nuntil = {tumbles = 5}") +
                             step("rest", 0, "hold_s = 1\nback_to = \"tumble\"\ntimes = 3");
  const Run a = play(script);
  const Run b = play(script);
  std::vector<std::string> labels;
  for (const auto& event : a.steps) labels.push_back(event.label);
  EXPECT_THAT(labels, ElementsAre("tumble", "rest", "tumble", "rest", "tumble", "rest"));
  EXPECT_TRUE(readFile(a.directory / "log.lcmlog") == readFile(b.directory / "log.lcmlog"));
  // The experiment file in the run folder has the same script.
  const Finished again = run("lab check " + (a.directory / "experiment.toml").string());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("until 5 tumbles, at most 30 s, if not: the script goes on"));
  EXPECT_THAT(again.output, HasSubstr("back to \"tumble\", 3 times in all"));
}

}  // namespace
}  // namespace lab::system_test
