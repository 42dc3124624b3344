/// Programs of motion on the chip's binary, compared with the core on the host.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include "tests/robot/random_programs.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {

/// Sums over the compared runs.
struct MotionTally {
  double robot_seconds = 0;
  std::uint64_t holds = 0;
  std::uint64_t interrupted = 0;
  std::uint64_t unsent = 0;     ///< STEPs for which the chip's queue had no room
  std::uint64_t cut_short = 0;  ///< programs whose comparison ended at such a STEP
};

/// Runs a program on the chip for `seconds` and compares every hold that it reports with the core,
/// which gets the same seed, sensors and senses. The chip's times of scans are not known, so the
/// core looks at a condition when the chip has ended a hold early; conditions must not draw.
inline void compareMotion(const std::vector<std::uint8_t>& code, std::uint32_t seed, double seconds,
                          MotionTally& tally) {
  MemoryPrograms library;
  dynamics::CoreSettings settings;
  settings.light.count = 1;
  settings.light.bands[0] = {0, 1024, 0};
  settings.programs[0] = library.add(code);
  settings.reversal.enabled = false;
  settings.robot_id = static_cast<std::uint16_t>(seed % 1000);
  settings.half_wheel_base_um = 30000 + static_cast<std::int32_t>(seed % 20000);
  std::vector<std::uint8_t> image = storeWithUid(kTestUid);
  firmware::encodeProgram(code.data(), static_cast<std::uint8_t>(code.size()), 0, image.data());

  RobotOnChip robot({}, image);
  dynamics::Sensors sensors;
  sensors.light_front = sensors.light_back = static_cast<std::uint16_t>(seed % 1024);
  robot.light(sensors.light_front);
  for (unsigned sensor = 0; sensor < dynamics::kIrSensors; ++sensor) {
    sensors.ir[sensor] = static_cast<std::uint16_t>((seed >> sensor) % 1024);
    robot.ir(sensor, sensors.ir[sensor]);
  }
  wire::SetSenses senses;
  for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) {
    senses.sense[i] =
        static_cast<std::int32_t>(seed * 2654435761U + i * 40503U * 65536U) >> (2 * i);
  }
  robot.chip().switchOn();
  robot.run(100);
  robot.command(wire::SetParam{wire::kTelemetryPeriod, 0});
  robot.command(wire::SetSeed{0xC0FFEE, seed});
  robot.send(senses);
  robot.run(20);
  robot.configure(settings);
  robot.forget();
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable)).status, wire::kOk);

  dynamics::RobotCore core(library);
  core.seed(std::uint64_t{0xC0FFEE} << 32 | seed);
  for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) core.setSense(i, senses.sense[i]);
  bool started = false;
  std::uint32_t draws_apart = 0;
  const double begin = robot.now();
  const double end = begin + seconds * 1000;
  while (robot.now() < end) {
    robot.run(1000, 100);
    for (const auto& heard : robot.all<wire::Step>()) {
      const wire::Step& step = heard.message;
      if (step.slot == dynamics::kNoSlot) continue;
      if (!started) {
        started = true;
        core.configure(step.t_ms, settings);
        core.sense(step.t_ms, sensors);
        core.renewLease(step.t_ms, dynamics::RobotCore::kNoEventMs);
        draws_apart = step.draw_count - core.record().draw_count;
      }
      // The core begins the holds up to this one.
      while (core.record().draw_count + draws_apart != step.draw_count) {
        const std::uint32_t before = core.record().draw_count;
        if (before + 1 + draws_apart != step.draw_count) {
          // A hold without a STEP. If a condition began it or ended the one before, the time of the
          // scan is not known: nothing can be compared from here on, because odometry and times
          // depend on it.
          tally.unsent += step.draw_count - (before + 1 + draws_apart);
          ++tally.cut_short;
          tally.robot_seconds += (robot.now() - begin) / 1000;
          return;
        }
        if (!core.advanceOne(step.t_ms)) {
          core.sense(step.t_ms, sensors);
          ++tally.interrupted;
        }
        ASSERT_EQ(core.record().draw_count, before + 1)
            << "the chip began a hold at " << step.t_ms << " ms, the core did not";
      }
      ASSERT_EQ(step.t_ms, core.holdStartMs()) << "draw " << step.draw_count;
      ASSERT_EQ(step.left_um_s, core.record().held.left) << "draw " << step.draw_count;
      ASSERT_EQ(step.right_um_s, core.record().held.right) << "draw " << step.draw_count;
      ASSERT_EQ(step.duration_ms, core.holdDurationMs()) << "draw " << step.draw_count;
      ASSERT_EQ(step.phase, core.record().phase) << "draw " << step.draw_count;
      ASSERT_EQ(step.rng, core.rng().digest()) << "draw " << step.draw_count;
      ++tally.holds;
    }
    robot.forget();
  }
  EXPECT_TRUE(started);
  EXPECT_EQ(robot.chip().power(), ChipPower::kRunning);
  tally.robot_seconds += seconds;
}

/// Random programs, each for half a minute.
inline MotionTally compareRandomMotion(std::uint64_t seed, int programs) {
  RandomProgramOptions options;
  options.draws_in_conditions = false;
  options.shortest_hold_256ths = 10;  // a STEP takes 10 ms on the line
  RandomPrograms random(seed, options);
  MotionTally tally;
  for (int i = 0; i < programs && !testing::Test::HasFailure(); ++i) {
    compareMotion(random.next(),
                  static_cast<std::uint32_t>(seed * 7919) + 104729U * static_cast<std::uint32_t>(i),
                  30, tally);
    EXPECT_FALSE(testing::Test::HasFailure()) << "program " << i;
  }
  std::cout << tally.robot_seconds << " robot-seconds on the chip: " << tally.holds
            << " holds equal, " << tally.interrupted << " of them after a condition, "
            << tally.unsent << " STEPs without room, " << tally.cut_short
            << " programs cut short by them\n";
  return tally;
}

}  // namespace lab::emulator
