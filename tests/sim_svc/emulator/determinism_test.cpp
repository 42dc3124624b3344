// The same inputs give the same outputs, however the time is divided into steps.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

struct Trace {
  std::vector<std::uint64_t> all;
  bool operator==(const Trace&) const = default;
};

/// Ten seconds with light, walls, orders, a stop, a hang and a reset. Records every byte and motor
/// change with its cycle.
Trace traceOf(double slice_ms, std::uint64_t run_limit, std::uint64_t seed, bool profile = false) {
  ChipSettings settings;
  settings.run_limit = run_limit;
  settings.profile = profile;
  const dynamics::CoreSettings core = fourPrograms({.abp = "50 ms"});
  RobotOnChip robot(settings, storeWithPrograms(core));
  robot.chip().switchOn();
  robot.run(60, slice_ms);
  const auto send = [&](const auto& message) {
    robot.send(message);
    robot.run(40, slice_ms);
  };
  for (std::uint8_t slot = 0; slot < 4; ++slot) send(wire::programMessage(core, slot));
  send(wire::lightMessage(core));
  send(wire::motionMessage(core));
  send(wire::Apply{wire::configCrc(core)});
  send(wire::SetSeed{1, static_cast<std::uint32_t>(seed)});
  wire::Order order;
  order.mode = wire::Order::kTable;
  order.config = wire::configCrc(core);
  order.lease_ms = 700;
  Random random(seed);
  for (int i = 0; i < 48; ++i) {
    order.id = static_cast<std::uint8_t>(i);
    robot.send(order);
    robot.light(static_cast<std::uint16_t>(random.next() % 1024));
    robot.ir(static_cast<unsigned>(random.next() % 6),
             static_cast<std::uint16_t>(random.next() % 1024));
    robot.run(200, slice_ms);
    if (i == 30) robot.chip().hang();
    if (i == 40) robot.chip().reset();
  }
  Trace trace;
  for (const SentByte& byte : robot.bytes()) trace.all.push_back(byte.cycle * 256 + byte.value);
  for (const DutyChange& change : robot.changes()) {
    trace.all.push_back(change.cycle);
    trace.all.push_back(static_cast<std::uint64_t>(change.duty.left * 1000 + change.duty.right));
  }
  return trace;
}

TEST(Determinism, StepLengthAndRunLimitDoNotChangeTheOutputs) {
  const Trace reference = traceOf(2, 8000, 1);
  EXPECT_GT(reference.all.size(), 5000U);
  EXPECT_EQ(traceOf(2, 8000, 1), reference);
  EXPECT_EQ(traceOf(1, 8000, 1), reference);
  EXPECT_EQ(traceOf(10, 8000, 1), reference);
  EXPECT_EQ(traceOf(0.5, 8000, 1), reference);
  EXPECT_EQ(traceOf(2, 2, 1), reference);
  EXPECT_EQ(traceOf(2, 100000, 1), reference);
  EXPECT_EQ(traceOf(2, 8000, 1, true), reference);
  EXPECT_NE(traceOf(2, 8000, 2), reference);
}

TEST(Determinism, RobotsDoNotInfluenceEachOther) {
  const auto bytes = [](RobotOnChip& robot) {
    std::vector<std::uint64_t> all;
    for (const SentByte& byte : robot.bytes()) all.push_back(byte.cycle * 256 + byte.value);
    return all;
  };
  RobotOnChip alone;
  alone.start();
  for (int i = 0; i < 500; ++i) alone.run(2);
  RobotOnChip one;
  RobotOnChip two;
  one.start();
  two.start();
  for (int i = 0; i < 500; ++i) {
    two.light(static_cast<std::uint16_t>(i));
    one.run(2);
    two.run(2);
  }
  EXPECT_EQ(bytes(one), bytes(alone));
  EXPECT_NE(bytes(two), bytes(alone));
}

}  // namespace
}  // namespace lab::emulator
