#include "runner/script/step_condition.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "common/experiment/program_messages.hpp"
#include "tests/support/programs.hpp"

namespace lab::runner::step_condition_test {
namespace {

constexpr std::int64_t kBegin = 1'000'000;

Experiment threeRobots() {
  Experiment experiment;
  for (const int id : {1, 2, 3}) {
    experiment.robots.emplace_back();
    experiment.robots.back().id = id;
  }
  for (const char* name : {"abp", "slow"}) {
    Program& program = experiment.programs[name];
    program = test::abp(name[0] == 'a' ? 0.03 : 0.01, 0.5, 3);
    program.name = name;
  }
  return experiment;
}

struct At {
  std::int32_t robot;
  double x;
  double y;
};

tracked_frame_t frame(std::int64_t utime, const std::vector<At>& poses) {
  tracked_frame_t frame{};
  frame.utime = utime;
  for (const At& at : poses) {
    frame.robots.emplace_back();
    frame.robots.back().robot_id = at.robot;
    frame.robots.back().x = at.x;
    frame.robots.back().y = at.y;
  }
  frame.num_robots = static_cast<std::int32_t>(frame.robots.size());
  return frame;
}

EndCondition rectangle(Who who) {
  EndCondition until;
  until.region = Region::kRectangle;
  until.x = 1;
  until.y = 1;
  until.width = 0.4;
  until.height = 0.2;
  until.who = who;
  return until;
}

robot_status_t status(std::int64_t utime, std::int32_t robot, std::int32_t tumbles) {
  robot_status_t status{};
  status.robots.resize(1);
  status.num_robots = 1;
  status.robots[0].robot_id = robot;
  status.robots[0].utime = utime;
  status.robots[0].tumble_count = tumbles;
  return status;
}

analysis_t analysis(const Experiment& experiment, const char* program, std::int32_t robot,
                    double value, double sigma) {
  analysis_t message{};
  message.utime = kBegin + 5;
  message.robot_id = robot;
  message.program = toId(experiment.programs.at(program));
  message.estimates.resize(2);
  message.num_estimates = 2;
  message.estimates[0].name = "v";
  message.estimates[1].name = "D_r";
  message.estimates[1].value = value;
  message.estimates[1].sigma = sigma;
  return message;
}

TEST(StepCondition, IsMetByAnyRobotOfTheExperimentInTheRectangle) {
  StepCondition dut(threeRobots(), rectangle(Who::kAny), {}, kBegin);
  dut.take(frame(kBegin, {{1, 1.21, 1}, {2, 1, 1.11}, {77, 1, 1}}));
  EXPECT_EQ(dut.met(), std::nullopt);
  EXPECT_EQ(dut.progress(), "robot 1 came nearest, to 1.0 cm");
  dut.take(frame(kBegin + 20, {{3, 1.2, 0.9}}));
  EXPECT_EQ(dut.met(), kBegin + 20);
}

TEST(StepCondition, NeedsAllRobotsInsideAtATimeAllowingMissedFrames) {
  StepCondition dut(threeRobots(), rectangle(Who::kAll), {}, kBegin);
  dut.take(frame(kBegin, {{1, 1, 1}, {2, 1, 1}, {3, 0, 0}}));
  dut.take(frame(kBegin + 20'000, {{1, 0, 0}, {2, 1, 1}, {3, 1, 1}}));
  EXPECT_EQ(dut.met(), std::nullopt);
  EXPECT_EQ(dut.progress(), "at most 2 of 3 robots were there at the same time");
  dut.take(frame(kBegin + 40'000, {{1, 1, 1}, {2, 1, 1}}));
  EXPECT_EQ(dut.met(), kBegin + 40'000);
}

TEST(StepCondition, ARobotUnseenForLongIsNotInside) {
  StepCondition dut(threeRobots(), rectangle(Who::kAll), {}, kBegin);
  dut.take(frame(kBegin, {{3, 1, 1}}));
  dut.take(frame(kBegin + 600'000, {{1, 1, 1}, {2, 1, 1}}));
  EXPECT_EQ(dut.met(), std::nullopt);
}

TEST(StepCondition, CanConcernOneRobot) {
  EndCondition until = rectangle(Who::kAny);
  until.robot = 2;
  StepCondition dut(threeRobots(), until, {}, kBegin);
  dut.take(frame(kBegin, {{1, 1, 1}, {2, 0, 0}}));
  EXPECT_EQ(dut.met(), std::nullopt);
  dut.take(frame(kBegin + 1, {{2, 1, 1}}));
  EXPECT_EQ(dut.met(), kBegin + 1);
}

TEST(StepCondition, UsesOnlyTheEstimateOfItsProgramAndPool) {
  const Experiment experiment = threeRobots();
  EndCondition until;
  until.estimate = "D_r";
  until.program = "abp";
  until.relative_error = 0.1;
  StepCondition dut(experiment, until, {}, kBegin);
  EXPECT_EQ(dut.progress(), "D_r was not determined, wanted with a relative error of 0.1");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  dut.take(analysis(experiment, "slow", analysis_t::POOL, 1, 0.01));
  dut.take(analysis(experiment, "abp", 1, 1, 0.01));
  dut.take(analysis(experiment, "abp", analysis_t::POOL, nan, 0.01));
  const double infinite = std::numeric_limits<double>::infinity();
  dut.take(analysis(experiment, "abp", analysis_t::POOL, infinite, 0.01));
  dut.take(analysis(experiment, "abp", analysis_t::POOL, 0, 0));
  EXPECT_EQ(dut.met(), std::nullopt);
  dut.take(analysis(experiment, "abp", analysis_t::POOL, -1, 0.123));
  EXPECT_EQ(dut.met(), std::nullopt);
  EXPECT_EQ(dut.progress(), "relative error 0.123, wanted 0.1");
  dut.take(analysis(experiment, "abp", analysis_t::POOL, -1, 0.099));
  EXPECT_EQ(dut.met(), kBegin + 5);
}

TEST(StepCondition, CountsTumblesSinceItsStepBegan) {
  TumbleCount tumbles;
  tumbles.take(status(1, 1, 40));
  tumbles.take(status(2, 1, 45));
  EndCondition until;
  until.tumbles = 3;
  StepCondition dut(threeRobots(), until, tumbles, kBegin);
  tumbles.take(status(3, 1, 47));
  tumbles.take(status(4, 2, 1000));  // its first status
  dut.take(tumbles);
  EXPECT_EQ(dut.met(), std::nullopt);
  EXPECT_EQ(dut.progress(), "2 tumbles, wanted 3");
  tumbles.take(status(5, 2, 1001));
  dut.take(tumbles);
  EXPECT_EQ(dut.met(), 5);
}

TEST(TumbleCount, HandlesAWrapAndAReboot) {
  TumbleCount dut;
  dut.take(status(1, 1, std::numeric_limits<std::int32_t>::max() - 1));
  dut.take(status(2, 1, std::numeric_limits<std::int32_t>::min()));
  EXPECT_EQ(dut.total(1), 2);
  dut.take(status(3, 1, 4));  // four tumbles since a reboot
  EXPECT_EQ(dut.total(1), 6);
  dut.take(status(4, 1, 5));
  dut.take(status(2, 1, 4000));  // late on the network
  EXPECT_EQ(dut.total(1), 7);
  EXPECT_EQ(dut.total(2), 0);
  EXPECT_EQ(dut.lastUtime(), 4);
}

}  // namespace
}  // namespace lab::runner::step_condition_test
