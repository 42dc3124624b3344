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

/// Valid settings: three programs, two bands.
CoreSettings good() {
  CoreSettings settings;
  settings.programs[0] = 0x12345678;
  settings.programs[1] = 0x9ABCDEF0;
  settings.programs[2] = 0xFFFFFFFF;
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
  settings.robot_id = 300;
  settings.half_wheel_base_um = 40000;
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
    message.hash = 1;
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
  EXPECT_EQ(payloads.size(), 4U * 5U + 24U + 23U);
  EXPECT_EQ(configCrc(settings), crcByTheBook(payloads));
}

TEST(ConfigCrc, ChangesWithEverySetting) {
  const std::vector<std::function<void(CoreSettings&)>> changes{
      [](CoreSettings& s) { ++s.programs[0]; },
      [](CoreSettings& s) { ++s.programs[1]; },
      [](CoreSettings& s) { ++s.programs[2]; },
      [](CoreSettings& s) { ++s.programs[3]; },
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
      [](CoreSettings& s) { ++s.robot_id; },
      [](CoreSettings& s) { ++s.half_wheel_base_um; },
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

constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();

const std::vector<Case> kCases{
    {"no change", kNoFault, [](CoreSettings&) {}},
    {"any program", kNoFault, [](CoreSettings& s) { s.programs[1] = 1; }},
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
    {"wheel base 0", kBadLimits, [](CoreSettings& s) { s.half_wheel_base_um = 0; }},
    {"wheel base negative", kBadLimits, [](CoreSettings& s) { s.half_wheel_base_um = kLeast; }},
    {"wheel base 2 m", kNoFault, [](CoreSettings& s) { s.half_wheel_base_um = 1000000; }},
    {"wheel base beyond 2 m", kBadLimits, [](CoreSettings& s) { s.half_wheel_base_um = 1000001; }},
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
