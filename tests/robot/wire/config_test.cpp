#include "robot/wire/config.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "tests/robot/wire/frames.hpp"

namespace lab::wire {
namespace {

using dynamics::CoreSettings;
using dynamics::LightBand;
using dynamics::ProgramKind;

/// Valid settings: one program of each moving kind, two bands.
CoreSettings good() {
  CoreSettings settings;
  settings.programs[0] = {dynamics::kAbp, 50000, 100000, 1000, 0, 0, 0, 0, 0};
  settings.programs[1] = {dynamics::kBp, 0, 70000, 200, 0, 0, 0, 0, 0};
  settings.programs[2] = {dynamics::kRtp, 50000, 0, 0, 333333, 500, 235619, 0, 0};
  settings.programs[3] = {dynamics::kWheels, 0, 0, 0, 0, 0, 0, -100000, 100000};
  settings.light.count = 2;
  settings.light.bands[0] = LightBand{0, 500, 2};
  settings.light.bands[1] = LightBand{500, 1024, 0};
  settings.light.hysteresis = 12;
  settings.light.reading = dynamics::kFrontLight;
  settings.reversal.distance_um = 300000;
  settings.reversal.speed_um_s = 90000;
  settings.reversal.ir_margin = 9;
  settings.max_wheel_um_s = 260000;
  settings.sensor_period_ms = 10;
  return settings;
}

/// The settings of another robot after they were sent over the line.
CoreSettings told(const CoreSettings& settings) {
  CoreSettings other;
  other.reversal.enabled = !settings.reversal.enabled;
  const auto tell = [&](const auto& message) {
    Frame frame;
    pack(message, 0, frame);
    auto back = message;
    back = {};
    EXPECT_TRUE(unpack(frame, back));
    stage(back, other);
  };
  for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    tell(programMessage(settings, slot));
  }
  tell(lightMessage(settings));
  tell(motionMessage(settings));
  return other;
}

TEST(Staging, TransfersEverySetting) {
  EXPECT_TRUE(told(good()) == good());
  EXPECT_TRUE(told(CoreSettings{}) == CoreSettings{});
  CoreSettings settings = good();
  settings.reversal.enabled = false;
  EXPECT_TRUE(told(settings) == settings);
}

TEST(Staging, IgnoresANonexistentSlot) {
  for (int slot = dynamics::kSlots; slot < 256; ++slot) {
    CoreSettings settings = good();
    SetProgram message = programMessage(settings, 0);
    message.slot = static_cast<std::uint8_t>(slot);
    message.speed_um_s = 1;
    stage(message, settings);
    EXPECT_TRUE(settings == good()) << slot;
  }
}

TEST(ConfigCrc, IsTheCrcOfTheSixPayloadsInTheirOrder) {
  const CoreSettings settings = good();
  Bytes payloads;
  const auto add = [&](const auto& message) {
    Frame frame;
    pack(message, 0, frame);
    payloads = payloads + Bytes(frame.payload, frame.payload + frame.size);
  };
  for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) add(programMessage(settings, slot));
  add(lightMessage(settings));
  add(motionMessage(settings));
  EXPECT_EQ(payloads.size(), 4U * 34U + 24U + 17U);
  EXPECT_EQ(configCrc(settings), crcByTheBook(payloads));
}

TEST(ConfigCrc, ChangesWithEverySetting) {
  const std::vector<std::function<void(CoreSettings&)>> changes{
      [](CoreSettings& s) { s.programs[0].kind = dynamics::kNoisyAbp; },
      [](CoreSettings& s) { ++s.programs[0].speed_um_s; },
      [](CoreSettings& s) { ++s.programs[1].amplitude_um_s; },
      [](CoreSettings& s) { ++s.programs[1].hold_ms; },
      [](CoreSettings& s) { ++s.programs[2].mean_run_us; },
      [](CoreSettings& s) { ++s.programs[2].tumble_ms; },
      [](CoreSettings& s) { ++s.programs[2].tumble_amplitude_um_s; },
      [](CoreSettings& s) { ++s.programs[3].left_um_s; },
      [](CoreSettings& s) { ++s.programs[3].right_um_s; },
      [](CoreSettings& s) { ++s.light.count; },
      [](CoreSettings& s) { s.light.reading = dynamics::kBackLight; },
      [](CoreSettings& s) { ++s.light.hysteresis; },
      [](CoreSettings& s) { ++s.light.bands[3].low; },
      [](CoreSettings& s) { ++s.light.bands[3].high; },
      [](CoreSettings& s) { ++s.light.bands[3].slot; },
      [](CoreSettings& s) { s.reversal.enabled = false; },
      [](CoreSettings& s) { ++s.reversal.distance_um; },
      [](CoreSettings& s) { ++s.reversal.speed_um_s; },
      [](CoreSettings& s) { ++s.reversal.ir_margin; },
      [](CoreSettings& s) { ++s.max_wheel_um_s; },
      [](CoreSettings& s) { ++s.sensor_period_ms; },
      [](CoreSettings& s) { std::swap(s.programs[0], s.programs[1]); }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    CoreSettings settings = good();
    changes[i](settings);
    EXPECT_NE(configCrc(settings), configCrc(good())) << "change " << i;
  }
}

TEST(ConfigCrc, IsNeverZero) {
  // Among 65536 consecutive settings, one has a CRC of 0, which is replaced by 1.
  CoreSettings settings = good();
  int ones = 0;
  for (int distance = 0; distance < 65536; ++distance) {
    settings.reversal.distance_um = static_cast<std::uint32_t>(distance);
    const std::uint16_t crc = configCrc(settings);
    ASSERT_NE(crc, 0);
    ones += crc == 1 ? 1 : 0;
  }
  EXPECT_EQ(ones, 2) << "one of them would have been 0";
}

struct Case {
  const char* what;
  ConfigFault fault;
  std::function<void(CoreSettings&)> change;
};

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();

const std::vector<Case> kCases{
    {"no change", kNoFault, [](CoreSettings&) {}},
    {"kind 6", kBadKind, [](CoreSettings& s) { s.programs[1].kind = static_cast<ProgramKind>(6); }},
    {"kind 255", kBadKind,
     [](CoreSettings& s) { s.programs[3].kind = static_cast<ProgramKind>(255); }},
    {"an unused program may hold anything", kNoFault,
     [](CoreSettings& s) { s.programs[0] = {dynamics::kNone, kMost, kLeast, 0, 0, 0, 0, 0, 0}; }},
    {"hold 0", kBadTime, [](CoreSettings& s) { s.programs[0].hold_ms = 0; }},
    {"hold 1 h", kNoFault, [](CoreSettings& s) { s.programs[0].hold_ms = 3600000; }},
    {"hold beyond 1 h", kBadTime, [](CoreSettings& s) { s.programs[0].hold_ms = 3600001; }},
    {"mean run 0", kBadTime, [](CoreSettings& s) { s.programs[2].mean_run_us = 0; }},
    {"mean run 100 s", kNoFault, [](CoreSettings& s) { s.programs[2].mean_run_us = 100000000; }},
    {"mean run beyond 100 s", kBadTime,
     [](CoreSettings& s) { s.programs[2].mean_run_us = 100000001; }},
    {"tumble 0", kBadTime, [](CoreSettings& s) { s.programs[2].tumble_ms = 0; }},
    {"tumble beyond 1 h", kBadTime, [](CoreSettings& s) { s.programs[2].tumble_ms = 3600001; }},
    {"ABP at the limit", kNoFault, [](CoreSettings& s) { s.programs[0].speed_um_s = 160000; }},
    {"ABP over it by v", kTooFast, [](CoreSettings& s) { s.programs[0].speed_um_s = 160001; }},
    {"ABP over it backwards", kTooFast,
     [](CoreSettings& s) { s.programs[0].speed_um_s = -160001; }},
    {"ABP over it by its amplitude", kTooFast,
     [](CoreSettings& s) { s.programs[0].amplitude_um_s = -210001; }},
    {"ABP at the end of the range", kTooFast,
     [](CoreSettings& s) { s.programs[0].amplitude_um_s = kMost; }},
    {"ABP at the other end", kTooFast,
     [](CoreSettings& s) { s.programs[0].amplitude_um_s = kLeast; }},
    {"BP over it", kTooFast, [](CoreSettings& s) { s.programs[1].amplitude_um_s = 260001; }},
    {"RTP runs too fast", kTooFast, [](CoreSettings& s) { s.programs[2].speed_um_s = 260001; }},
    {"RTP tumbles too fast", kTooFast,
     [](CoreSettings& s) { s.programs[2].tumble_amplitude_um_s = -260001; }},
    {"left wheel", kTooFast, [](CoreSettings& s) { s.programs[3].left_um_s = kLeast; }},
    {"right wheel", kTooFast, [](CoreSettings& s) { s.programs[3].right_um_s = 260001; }},
    {"bands overlap", kBadBands, [](CoreSettings& s) { s.light.bands[1].low = 499; }},
    {"band empty", kBadBands, [](CoreSettings& s) { s.light.bands[0].high = 0; }},
    {"band beyond the converter", kBadBands, [](CoreSettings& s) { s.light.bands[1].high = 1025; }},
    {"band for slot 4", kBadBands, [](CoreSettings& s) { s.light.bands[1].slot = 4; }},
    {"five bands", kBadBands, [](CoreSettings& s) { s.light.count = 5; }},
    {"255 bands", kBadBands, [](CoreSettings& s) { s.light.count = 255; }},
    {"reading 3", kBadBands,
     [](CoreSettings& s) { s.light.reading = static_cast<dynamics::LightReading>(3); }},
    {"hysteresis 1024", kBadBands, [](CoreSettings& s) { s.light.hysteresis = 1024; }},
    {"reversal too fast", kBadReversal, [](CoreSettings& s) { s.reversal.speed_um_s = 260001; }},
    {"reversal at 0", kBadReversal, [](CoreSettings& s) { s.reversal.speed_um_s = 0; }},
    {"reversal backwards", kBadReversal, [](CoreSettings& s) { s.reversal.speed_um_s = -1; }},
    {"reversal of 4 m", kNoFault, [](CoreSettings& s) { s.reversal.distance_um = 4000000; }},
    {"reversal beyond 4 m", kBadReversal,
     [](CoreSettings& s) { s.reversal.distance_um = 4000001; }},
    {"disabled reversal with any values", kNoFault,
     [](CoreSettings& s) {
       s.reversal = {false, 4000001, -1, 0};
     }},
    {"fastest wheel 0", kBadLimits, [](CoreSettings& s) { s.max_wheel_um_s = 0; }},
    {"fastest wheel negative", kBadLimits, [](CoreSettings& s) { s.max_wheel_um_s = kLeast; }},
    {"fastest wheel beyond 5 m/s", kBadLimits, [](CoreSettings& s) { s.max_wheel_um_s = 5000001; }},
    {"sensor period 0", kBadLimits, [](CoreSettings& s) { s.sensor_period_ms = 0; }},
    {"sensor period beyond 1 s", kBadLimits, [](CoreSettings& s) { s.sensor_period_ms = 1001; }}};

TEST(FirstFault, ReportsEachFault) {
  for (const Case& each : kCases) {
    CoreSettings settings = good();
    each.change(settings);
    EXPECT_EQ(firstFault(settings), each.fault) << each.what;
  }
}

}  // namespace
}  // namespace lab::wire
