// Commands over a line with bit errors: each is executed exactly once, if necessary after a later
// repetition of the order. LAB_COMMANDS is the number of commands.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/robot_bridge/bridge_fixture.hpp"

namespace lab::bridge {
namespace {

constexpr double kBitErrorRate = 1e-4;
constexpr int kCommands = LAB_COMMANDS;

class NoisyLineTest : public BridgeFixture {
 protected:
  NoisyLineTest() : BridgeFixture(1) {}
};

TEST_F(NoisyLineTest, EveryCommandIsExecutedExactlyOnce) {
  WireRobotOptions options;
  options.bit_error_rate = kBitErrorRate;
  options.error_seed = 5;
  WireRobot& robot = addRobot(1, options);
  start();
  command(drive({1}, 0, 0), 1);
  runCommanded(3);
  ASSERT_EQ(last[1].command_seq, 1);

  const std::uint32_t first_epoch = robot.report().program_epoch;
  int late = 0;  // commands that needed a repetition of the order
  int never = 0;
  int wrong = 0;  // speeds that were never ordered
  for (int i = 1; i <= kCommands; ++i) {
    const double speed = 0.001 * (1 + i % 200);
    command(drive({1}, speed, -speed), i + 1);
    bool obeyed = false;
    for (int waited_ms = 0; !obeyed && waited_ms < 2000; waited_ms += 10) {
      if (waited_ms % 200 == 190) repeatCommand();
      if (waited_ms == 450) ++late;
      run(0.01);
      obeyed = last[1].command_seq == i + 1;
    }
    if (!obeyed) ++never;
    const dynamics::WheelSpeedsUmS wheels = robot.device().core().wheels();
    if (wheels.left != -wheels.right || std::abs(wheels.left - speed * 1e6) > 1) ++wrong;
    if (std::abs(last[1].wheel_left) > 0.2001) ++wrong;
    statuses.clear();
  }
  EXPECT_EQ(never, 0);
  EXPECT_EQ(robot.report().program_epoch - first_epoch, static_cast<std::uint32_t>(kCommands))
      << "a command was executed twice, or not at all";
  EXPECT_GT(last[1].link_errors, kCommands / 50) << "the line was not noisy";
  // One damaged frame in 65536 passes the CRC.
  EXPECT_LE(wrong, 2);
  EXPECT_LE(late, kCommands / 500 + 3);
  RecordProperty("damaged_frames", last[1].link_errors);
  RecordProperty("late", late);
  std::printf("%d commands, %d damaged frames, %d with a repeat of the state, %d wrong\n",
              kCommands, last[1].link_errors, late, wrong);
}

}  // namespace
}  // namespace lab::bridge
