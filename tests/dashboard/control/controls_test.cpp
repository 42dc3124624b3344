#include "dashboard/control/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/experiment/light_messages.hpp"
#include "tests/dashboard/message_samples.hpp"

namespace lab::dashboard {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

experiment_status_t statusOfRun(std::int8_t phase = experiment_status_t::SCRIPT) {
  experiment_status_t status{};
  status.sender = "lab";
  status.phase = phase;
  return status;
}

struct ControlsBench {
  ControlsBench() { dut.take(statusOfRun(), kNow); }

  void answer(const experiment_command_t& command, const std::string& refusal = "") {
    experiment_status_t status = statusOfRun();
    status.commander = command.sender;
    status.command_instance = command.instance;
    status.command_seq = command.seq;
    status.refusal = refusal;
    dut.take(status, kNow);
  }
  std::string note() { return dut.noteJson(); }

  Controls dut{"dashboard", 9};
};

TEST(Controls, RepeatsARequestAtFiveHertzUntilItIsAnswered) {
  ControlsBench bench;
  ASSERT_EQ(bench.dut.request(MarkRun{"a fly"}, kNow), "");
  ASSERT_EQ(bench.dut.request(PauseScript{}, kNow), "");
  const auto first = bench.dut.due(kNow).experiment;
  ASSERT_TRUE(first);
  EXPECT_EQ(first->action, experiment_command_t::MARK);
  EXPECT_EQ(first->text, "a fly");
  EXPECT_FALSE(bench.dut.due(kNow + 199'000).experiment);
  EXPECT_EQ(bench.dut.due(kNow + 200'000).experiment->seq, first->seq);
  bench.answer(*first);
  EXPECT_THAT(bench.note(), HasSubstr("\"request\":\"mark\",\"text\":\"done\""));
  const auto second = bench.dut.due(kNow + 210'000).experiment;
  ASSERT_TRUE(second);
  EXPECT_EQ(second->action, experiment_command_t::PAUSE);
  EXPECT_GT(second->seq, first->seq);
  bench.answer(*second, "it is paused");
  EXPECT_THAT(bench.note(), HasSubstr("refused: it is paused"));
  EXPECT_FALSE(bench.dut.due(kNow + kSecond).experiment);
}

TEST(Controls, DropsAnUnansweredRequestAndGivesTheNextOneItsFullTimeout) {
  ControlsBench bench;
  ASSERT_EQ(bench.dut.request(PauseScript{}, kNow), "");
  ASSERT_EQ(bench.dut.request(ResumeScript{}, kNow), "");
  EXPECT_TRUE(bench.dut.due(kNow).experiment);
  EXPECT_FALSE(bench.dut.due(kNow + 5 * kSecond + 1).experiment);
  EXPECT_THAT(bench.note(), HasSubstr("no answer within 5 s"));
  EXPECT_EQ(bench.dut.due(kNow + 6 * kSecond).experiment->action, experiment_command_t::RESUME);
  EXPECT_TRUE(bench.dut.due(kNow + 10 * kSecond).experiment);
}

TEST(Controls, RefusesRequestsThatCannotBeCarriedOut) {
  Controls dut("dashboard", 9);
  EXPECT_THAT(dut.request(PauseScript{}, kNow), HasSubstr("no run is active"));
  dut.take(statusOfRun(), kNow);
  EXPECT_EQ(dut.request(PauseScript{}, kNow), "");
  EXPECT_NE(dut.request(SeekLog{3}, kNow), "");
  EXPECT_NE(dut.request(MarkRun{"two\nlines"}, kNow), "");
  EXPECT_NE(dut.request(ShowLight{1.5, 0}, kNow), "");
  EXPECT_NE(dut.request(ShowLight{0.5, -1}, kNow), "");
  EXPECT_NE(dut.request(ShowLight{std::nan(""), 0}, kNow), "");
  EXPECT_NE(dut.request(ReleaseLight{}, kNow), "");
  EXPECT_THAT(dut.request(PauseScript{}, kNow + 4 * kSecond), HasSubstr("no run is active"));
}

TEST(Controls, AReplayedLogAcceptsSeeksButNoStops) {
  Controls dut("dashboard", 9);
  dut.take(statusOfRun(experiment_status_t::PLAYING), kNow);
  EXPECT_NE(dut.request(StopRobots{}, kNow), "");
  EXPECT_NE(dut.request(MarkRun{"x"}, kNow), "");
  EXPECT_NE(dut.request(ShowLight{0.5, 0}, kNow), "");
  EXPECT_NE(dut.request(SpeedLog{0}, kNow), "");
  EXPECT_EQ(dut.request(SeekLog{12.5}, kNow), "");
  const DueCommands due = dut.due(kNow);
  EXPECT_FALSE(due.stop);
  EXPECT_EQ(due.experiment->action, experiment_command_t::SEEK);
  EXPECT_EQ(due.experiment->value, 12.5);
}

TEST(Controls, ShowsAStopUntilEveryRobotHasConfirmed) {
  ControlsBench bench;
  bench.dut.expect({3, 7});
  ASSERT_EQ(bench.dut.request(StopRobots{"smoke"}, kNow), "");
  const auto stop = bench.dut.due(kNow).stop;
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->reason, "smoke");
  robot_state_t state = stateOf(3);
  state.flags = robot_state_t::FLAG_STOPPED;
  state.stop_seq = stop->seq;
  bench.dut.take(statusOf({state}), kNow + 60'000);
  Json json = Json::parse(bench.dut.stopJson());
  EXPECT_EQ(json["state"], "stopping");
  EXPECT_EQ(json["by"], "dashboard");
  EXPECT_EQ(json["confirmed"], 1);
  EXPECT_EQ(json["unconfirmed"], Json({7}));
  EXPECT_EQ(json["took_ms"], nullptr);
  state.robot_id = 7;
  bench.dut.take(statusOf({state}), kNow + 80'000);
  json = Json::parse(bench.dut.stopJson());
  EXPECT_EQ(json["state"], "stopped");
  EXPECT_EQ(json["took_ms"], 80);
}

TEST(Controls, AnInvalidReasonDoesNotPreventAStop) {
  ControlsBench bench;
  EXPECT_EQ(bench.dut.request(StopRobots{"\x01\xff"}, kNow), "");
  EXPECT_EQ(bench.dut.due(kNow).stop->reason, "from the page");
}

TEST(Controls, WaitsUntilTheProjectorShowsTheLight) {
  ControlsBench bench;
  ASSERT_EQ(bench.dut.request(ShowLight{0.25, 2}, kNow), "");
  const auto command = bench.dut.due(kNow).light;
  ASSERT_TRUE(command);
  EXPECT_EQ(command->priority, light_command_t::MANUAL);
  EXPECT_EQ(command->layers.at(0).intensity, 0.25);
  light_status_t status{};
  status.utime = kNow + 20'000;
  status.commander = "lab";
  bench.dut.take(status, kNow + 20'000);
  EXPECT_EQ(bench.note(), "");
  status.commander = "dashboard";
  status.command_instance = 9;
  bench.dut.take(status, kNow + 30'000);
  EXPECT_THAT(bench.note(), HasSubstr("shown"));
  EXPECT_EQ(bench.dut.due(kNow + 2 * kSecond).light->release, 1) << "released after two seconds";
  ASSERT_EQ(bench.dut.request(ShowLight{0.5, 0}, kNow + 3 * kSecond), "");
  EXPECT_TRUE(bench.dut.due(kNow + 7 * kSecond).light);
  EXPECT_THAT(bench.note(), HasSubstr("the projector does not show it"));
}

TEST(Controls, ShowsOnlyRefusalsOfItsOwnLight) {
  ControlsBench bench;
  ASSERT_EQ(bench.dut.request(ShowLight{0.25, 0}, kNow), "");
  const std::int64_t seq = bench.dut.due(kNow).light.value().seq;
  light_status_t status{};
  status.utime = kNow + 20'000;
  status.last_refusal = formatRefusal("lab_light", seq, "somebody else's");
  bench.dut.take(status, kNow + 20'000);
  EXPECT_TRUE(bench.dut.due(kNow + 4 * kSecond).light);
  EXPECT_THAT(bench.note(), AllOf(HasSubstr("the projector does not show it"),
                                  Not(HasSubstr("somebody else's"))));
  ASSERT_EQ(bench.dut.request(ShowLight{0.5, 0}, kNow + 5 * kSecond), "");
  status.utime = kNow + 5 * kSecond;
  status.last_refusal =
      formatRefusal("dashboard", bench.dut.due(status.utime).light.value().seq, "its own");
  bench.dut.take(status, status.utime);
  EXPECT_TRUE(bench.dut.due(kNow + 9 * kSecond).light);
  EXPECT_THAT(bench.note(), HasSubstr("the projector does not show it: its own"));
}

}  // namespace
}  // namespace lab::dashboard
