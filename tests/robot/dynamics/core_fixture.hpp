#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "robot/dynamics/robot_core.hpp"
#include "tests/robot/programs.hpp"

namespace lab::dynamics {

/// ABP in slot 0 for light 0..512, RTP in slot 1 for light 512..900, no program above.
inline CoreSettings twoPrograms() {
  CoreSettings s;
  s.light.count = 2;
  s.light.bands[0] = LightBand{0, 512, 0};
  s.light.bands[1] = LightBand{512, 900, 1};
  s.programs[0] = hashOf(abpText("3 cm/s", "0.5 s", "3 rad/s"));
  s.programs[1] = hashOf(rtpText("5 cm/s", "1 1/s", "0.5 s"));
  return s;
}

/// The program of `phases` instead of the first one of twoPrograms().
inline CoreSettings running(std::vector<language::PhaseText> phases) {
  CoreSettings settings = twoPrograms();
  settings.programs[0] = hashOf(programText(std::move(phases)));
  return settings;
}

inline Sensors light(uint16_t counts) {
  Sensors sensors;
  sensors.light_front = counts;
  sensors.light_back = counts;
  return sensors;
}

/// A core that runs the ABP of twoPrograms since t0, seeded with 42.
inline RobotCore runningCore(uint32_t t0, const CoreSettings& settings = twoPrograms()) {
  RobotCore core(testPrograms());
  core.seed(42);
  core.configure(t0, settings);
  core.renewLease(t0, RobotCore::kNoEventMs);
  core.sense(t0, light(100));
  return core;
}

inline bool has(const RobotCore& core, CoreFlag flag) { return (core.report().flags & flag) != 0; }

inline void expectWheels(const RobotCore& core, int32_t left, int32_t right) {
  EXPECT_EQ(core.wheels().left, left);
  EXPECT_EQ(core.wheels().right, right);
}

}  // namespace lab::dynamics
