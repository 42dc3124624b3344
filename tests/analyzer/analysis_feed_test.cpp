#include "analyzer/analysis_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/experiment/program_messages.hpp"
#include "tests/support/programs.hpp"

namespace lab::analysis {
namespace {

constexpr std::int64_t kPeriod = 20'000;  // us
constexpr std::int64_t kStart = 1'700'000'000'000'000;

Program abp() { return test::abp(0.03, 0.5, 3); }

/// An experiment with this program.
Experiment withProgram(const Program& program) {
  Experiment experiment;
  experiment.programs[program.name] = program;
  return experiment;
}

/// One robot that drives straight and reports that it runs an ABP.
class StraightRobot {
 public:
  explicit StraightRobot(AnalysisFeed& feed) : feed_(feed) {}

  robot_status_t status{};
  tracked_frame_t frame{};

  void run(int frames) {
    for (int i = 0; i < frames; ++i) {
      const std::int64_t utime = kStart + ++count_ * kPeriod;
      frame.utime = utime;
      ++frame.frame;
      frame.robots.resize(1);
      frame.robots[0].robot_id = 4;
      frame.robots[0].x = 0.1 + 0.03 * 1e-6 * static_cast<double>(utime - kStart);
      frame.robots[0].confidence = confidence;
      frame.num_robots = 1;
      feed_.take(frame);
      status.utime = utime;
      status.robots.resize(1);
      status.num_robots = 1;
      robot_state_t& robot = status.robots[0];
      robot.utime = utime;
      robot.robot_id = 4;
      robot.program = program;
      robot.band = band;
      robot.program_epoch = epoch;
      robot.program_start_utime = program_start;
      robot.program_left = robot.program_right = 0.03;
      robot.flags = flags;
      feed_.take(status);
    }
  }

  program_id_t program = toId(abp());
  std::int8_t band = 0;
  std::int32_t epoch = 1;
  std::int64_t program_start = kStart;
  std::int32_t flags = 0;
  float confidence = 1;

 private:
  AnalysisFeed& feed_;
  std::int64_t count_ = 0;
};

ProgramResult poolOf(AnalysisFeed& feed) {
  feed.flush();
  const auto results = feed.results();
  if (results.empty()) return {};
  EXPECT_EQ(results.front().result.robot, kPool);
  return results.front().result;
}

TEST(AnalysisFeed, MapsMessagesToTheAnalysis) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);

  robot.run(500);

  const ProgramResult result = poolOf(dut);
  EXPECT_EQ(result.law, lawOf(abp(), 0.075));
  EXPECT_NEAR(result.observed, 10, 0.05);
  EXPECT_EQ(result.segments, 1);
  ASSERT_FALSE(result.curves.msd.empty());
  EXPECT_NEAR(result.curves.msd[0].value, 0.0006 * 0.0006, 1e-12);
  EXPECT_EQ(dut.lastFrameUtime(), kStart + 500 * kPeriod);
  EXPECT_EQ(dut.results().front().program.hash, abp().hash);
  EXPECT_EQ(dut.results().front().definition, abp());
}

// A joystick changes the speed with every message. Each speed as a program would exhaust memory.
TEST(AnalysisFeed, CountsManualControlAsNoProgram) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);
  robot.band = -1;
  robot.program.hash = 0;
  robot.program.name = kDrivenByHost;
  for (int i = 0; i < 20; ++i) {
    ++robot.epoch;
    robot.run(100);
  }
  dut.flush();
  EXPECT_TRUE(dut.results().empty());
}

TEST(AnalysisFeed, CutsAtARestartOfTheSender) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);
  robot.run(250);

  robot.status.instance = 2;  // the same epoch number, but another start
  robot.run(250);

  EXPECT_EQ(poolOf(dut).segments, 2);
}

TEST(AnalysisFeed, CutsIfTheProgramCountDecreases) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);
  robot.epoch = 5;
  robot.run(250);

  robot.epoch = 1;
  robot.run(250);

  EXPECT_EQ(poolOf(dut).segments, 2);
}

TEST(AnalysisFeed, DoesNotMistakeALateMessageForARestart) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);
  robot.epoch = 5;
  robot.run(250);
  robot_status_t late = robot.status;
  late.robots[0].utime -= 3 * kPeriod + 1;
  late.robots[0].program_epoch = 4;

  dut.take(late);
  robot.run(250);

  EXPECT_EQ(poolOf(dut).segments, 1);
}

TEST(AnalysisFeed, OmitsContactsAndStops) {
  for (const std::int32_t flag : {static_cast<std::int32_t>(robot_state_t::FLAG_CONTACT_ROBOT),
                                  static_cast<std::int32_t>(robot_state_t::FLAG_CONTACT_WALL),
                                  static_cast<std::int32_t>(robot_state_t::FLAG_STOPPED),
                                  static_cast<std::int32_t>(robot_state_t::FLAG_LEASE_EXPIRED)}) {
    AnalysisFeed dut(withProgram(abp()));
    StraightRobot robot(dut);
    robot.run(200);
    robot.flags = flag;
    robot.run(100);
    robot.flags = 0;
    robot.run(200);

    const ProgramResult result = poolOf(dut);
    EXPECT_EQ(result.segments, 2) << flag;
    EXPECT_LT(result.samples, 401) << flag;
  }
}

TEST(AnalysisFeed, OmitsPosesWithLowConfidence) {
  AnalysisFeed dut(withProgram(abp()));
  StraightRobot robot(dut);
  robot.run(200);

  robot.confidence = 0.2F;
  robot.run(100);

  EXPECT_EQ(poolOf(dut).samples, 200);
}

TEST(AnalysisFeed, MarksLagsThatASpatialLightSelects) {
  AnalysisFeed dut(withProgram(abp()));
  light_status_t light{};
  light.mix = 1;
  light.layers.resize(1);
  light.layers[0].kind = light_layer_t::DISK;
  light.layers[0].size = 0.2;
  light.layers[0].intensity = 1;
  light.num_layers = 1;
  dut.take(light);
  StraightRobot robot(dut);
  robot.run(250);
  robot.epoch = 2;  // it left the program after 5 s
  robot.program_start = kStart + 5'000'000;
  robot.run(1);

  EXPECT_GT(poolOf(dut).unbiased_lag, 0);
}

TEST(AnalysisFeed, MarksNoLagUnderUniformLight) {
  AnalysisFeed dut(withProgram(abp()));
  light_status_t light{};
  light.mix = 1;
  light.layers.resize(1);
  light.layers[0].kind = light_layer_t::UNIFORM;
  light.num_layers = 1;
  dut.take(light);
  StraightRobot robot(dut);
  robot.run(250);
  robot.epoch = 2;
  robot.program_start = kStart + 5'000'000;
  robot.run(1);

  EXPECT_EQ(poolOf(dut).unbiased_lag, 0);
}

// A joystick or a node of ROS 2 may load a program that the experiment does not have.
TEST(AnalysisFeed, TakesDefinitionsFromCommands) {
  Program other = test::rtp(0.05, 1, 0.5);
  robot_command_t command{};
  command.orders.resize(1);
  command.orders[0].bands.resize(1);
  command.orders[0].bands[0].program = toMessage(other);
  AnalysisFeed dut{Experiment{}};
  dut.take(command);
  StraightRobot robot(dut);
  robot.program = toId(other);
  robot.run(500);

  const ProgramResult result = poolOf(dut);
  EXPECT_EQ(result.law, lawOf(other, bodyOf(RobotHardware{})));
  EXPECT_TRUE(result.law->runs());
}

TEST(AnalysisFeed, GivesCurvesWithoutAVerdictForUnknownPrograms) {
  AnalysisFeed dut{Experiment{}};
  StraightRobot robot(dut);
  robot.program.hash = 77;
  robot.program.name = "of somebody else";
  robot.run(500);

  const ProgramResult result = poolOf(dut);
  EXPECT_FALSE(result.curves.msd.empty());
  EXPECT_EQ(result.verdict.judged, 0);
  EXPECT_THAT(result.law->whyNoVerdict(), testing::HasSubstr("not known"));
  EXPECT_EQ(dut.results().front().program.name, "of somebody else");
}

}  // namespace
}  // namespace lab::analysis
