/// Random and mutated bytes as programs on the chip's binary.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <random>
#include <vector>

#include "tests/robot/random_programs.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {

/// Loads `tries` programs that were valid before some of their bytes changed; the chip refuses
/// those that the host refuses, executes the others, and never restarts or becomes slow.
inline void loadAnyBytes(std::uint64_t seed, int tries) {
  std::mt19937_64 random(seed);
  RandomPrograms programs(seed);
  RobotOnChip robot;
  robot.start();
  robot.command(wire::SetParam{wire::kTelemetryPeriod, 0});
  const std::uint16_t boots = robot.last<wire::Hello>()->boot_id;
  int accepted = 0;
  for (int i = 0; i < tries && !testing::Test::HasFailure(); ++i) {
    std::vector<std::uint8_t> code = programs.next();
    const unsigned changes = 1 + static_cast<unsigned>(random() % 3);
    for (unsigned change = 0; change < changes; ++change) {
      code[random() % code.size()] =
          static_cast<std::uint8_t>(random() % 3 == 0 ? random() : random() % 70);
    }
    if (i % 8 == 0) {
      for (std::uint8_t& byte : code) byte = static_cast<std::uint8_t>(random());
    }
    dynamics::CoreSettings settings;  // without programs, so that places are free
    settings.reversal.enabled = false;
    settings.light.count = 1;
    settings.light.bands[0] = {0, 1024, 0};
    robot.forget();
    robot.configure(settings);
    const auto fault =
        dynamics::checkByteCode(code.data(), static_cast<std::uint16_t>(code.size())).fault;
    const wire::Ack ack = robot.load(code);
    ASSERT_EQ(ack.status, fault == dynamics::kValidByteCode ? wire::kOk : wire::kBadProgram);
    ASSERT_EQ(ack.detail, fault);
    if (fault != dynamics::kValidByteCode) continue;
    ++accepted;
    settings.programs[0] = testPrograms().add(code);
    robot.light(static_cast<std::uint16_t>(random() % 1024));
    robot.ir(static_cast<unsigned>(random() % 6), static_cast<std::uint16_t>(random() % 1024));
    robot.configure(settings);
    ASSERT_EQ(robot.command(robot.order(wire::Order::kTable)).status, wire::kOk);
    robot.run(150);
    ASSERT_EQ(robot.command(wire::Stop{1, wire::Stop::kStop}, 60).status, wire::kOk)
        << "it obeys within 60 ms whatever it computes";
    ASSERT_EQ(robot.chip().duty(), Duty{});
    robot.command(wire::Stop{2, wire::Stop::kRelease});
  }
  EXPECT_EQ(robot.chip().power(), ChipPower::kRunning);
  robot.forget();
  robot.send(wire::GetInfo{});
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Hello>()->boot_id, boots) << "it never restarted";
  std::cout << tries << " programs on the chip, " << accepted << " of them executed\n";
  EXPECT_GT(accepted, tries / 20);
  EXPECT_LT(accepted, tries);
}

}  // namespace lab::emulator
