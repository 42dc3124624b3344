/// Compares the draws of the firmware binary with those of the same sources on the host.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/robot/firmware/host_robot.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {

/// Programs with draws as fast as the line can transmit them: a STEP takes 11 ms at 38400 baud.
inline dynamics::CoreSettings fastPrograms() {
  return fourPrograms({"20 ms", "20 ms", "20 ms", "33 1/s", "20 ms"});
}

/// The commands for both before the draws begin.
template <class Robot>
void tellBoth(Robot&& tell, const dynamics::CoreSettings& settings, std::uint32_t seed) {
  tell(wire::SetParam{wire::kTelemetryPeriod, 0});
  for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    tell(wire::programMessage(settings, slot));
  }
  tell(wire::lightMessage(settings));
  tell(wire::motionMessage(settings));
  tell(wire::Apply{wire::configCrc(settings)});
  tell(wire::SetSeed{0xC0FFEE, seed});
  wire::Order order;
  order.id = 1;
  order.mode = wire::Order::kTable;
  order.config = wire::configCrc(settings);
  order.lease_ms = kLongLease;
  tell(order);
}

/// The STEPs with a slot selected by the light; times are relative to the first of them.
inline std::vector<wire::Step> fromTheFirst(const std::vector<wire::Step>& steps) {
  std::vector<wire::Step> counted;
  for (wire::Step step : steps) {
    if (step.slot == dynamics::kNoSlot) continue;
    counted.push_back(step);
  }
  const std::uint32_t begin = counted.empty() ? 0 : counted.front().t_ms;
  for (wire::Step& step : counted) step.t_ms -= begin;
  return counted;
}

inline std::vector<wire::Step> stepsOfChip(unsigned slot, std::uint32_t seed, std::size_t count) {
  RobotOnChip robot({}, storeWithPrograms(fastPrograms()));
  robot.light(lightOfSlot(slot));
  robot.chip().switchOn();
  robot.run(100);
  tellBoth([&](const auto& message) { robot.command(message); }, fastPrograms(), seed);
  std::vector<wire::Step> steps;
  while (steps.size() < count + 1) {
    robot.run(1000, 100);
    const auto heard = robot.all<wire::Step>();
    if (heard.empty()) {
      ADD_FAILURE() << "no STEP for a second after " << steps.size();
      break;
    }
    for (const auto& step : heard) steps.push_back(step.message);
    robot.forget();
  }
  return fromTheFirst(steps);
}

inline std::vector<wire::Step> stepsOfHost(unsigned slot, std::uint32_t seed, std::size_t count) {
  firmware::HostRobot robot(storeWithPrograms(fastPrograms()));
  dynamics::Sensors sensors;
  sensors.light_front = sensors.light_back = lightOfSlot(slot);
  robot.tick(sensors);
  tellBoth([&](const auto& message) { robot.receive(message); }, fastPrograms(), seed);
  for (std::uint64_t ms = 0; robot.steps().size() < count + 1 && ms < 1000 * count; ++ms) {
    robot.tick(sensors);
  }
  return fromTheFirst(robot.steps());
}

/// Compares the encoded messages.
inline void expectEqualSteps(unsigned slot, std::uint32_t seed, std::size_t count) {
  const auto chip = stepsOfChip(slot, seed, count);
  const auto host = stepsOfHost(slot, seed, count);
  ASSERT_GE(chip.size(), count);
  ASSERT_GE(host.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    wire::Frame a;
    wire::Frame b;
    wire::pack(chip[i], 0, a);
    wire::pack(host[i], 0, b);
    ASSERT_EQ(std::vector<std::uint8_t>(a.payload, a.payload + a.size),
              std::vector<std::uint8_t>(b.payload, b.payload + b.size))
        << "slot " << slot << " draw " << i << ": chip " << chip[i].draw_count << " at "
        << chip[i].t_ms << " ms, host " << host[i].draw_count << " at " << host[i].t_ms << " ms";
  }
  EXPECT_EQ(chip[count - 1].draw_count - chip[0].draw_count, count - 1);
}

}  // namespace lab::emulator
