#include "robot/wire/config.hpp"

#include "robot/wire/crc16.hpp"

namespace lab {
namespace wire {
namespace {

using dynamics::CoreSettings;
using dynamics::kSlots;

constexpr uint32_t kLongestReversalUm = 4000000UL;
constexpr int32_t kFastestWheelUmS = 5000000L;
constexpr uint16_t kLongestSensorPeriodMs = 1000;
constexpr int32_t kLargestHalfWheelBaseUm = 1000000L;

/// Computes a CRC over the fields in their form on the wire.
class FieldCrc {
 public:
  void operator()(const uint8_t& value) { add(&value, sizeof value); }
  void operator()(const uint16_t& value) { add(&value, sizeof value); }
  void operator()(const uint32_t& value) { add(&value, sizeof value); }
  void operator()(const int32_t& value) { add(&value, sizeof value); }
  uint16_t value() const { return crc_.value(); }

 private:
  // Inlined for every field, it would cost the chip a kilobyte.
  __attribute__((noinline)) void add(const void* bytes, uint8_t size) {
    for (uint8_t i = 0; i < size; ++i) {
      crc_.add(static_cast<const uint8_t*>(bytes)[i]);
    }
  }

  Crc16 crc_;
};

}  // namespace

SetProgram programMessage(const CoreSettings& settings, uint8_t slot) {
  SetProgram message;
  message.slot = slot;
  message.hash = settings.programs[slot];
  return message;
}

SetLight lightMessage(const CoreSettings& settings) {
  SetLight message;
  message.count = settings.light.count;
  message.reading = settings.light.reading;
  message.hysteresis = settings.light.hysteresis;
  for (uint8_t i = 0; i < kSlots; ++i) {
    message.low[i] = settings.light.bands[i].low;
    message.high[i] = settings.light.bands[i].high;
    message.slot[i] = settings.light.bands[i].slot;
  }
  return message;
}

SetMotion motionMessage(const CoreSettings& settings) {
  SetMotion message;
  message.reversal = settings.reversal.enabled ? 1 : 0;
  message.distance_um = settings.reversal.distance_um;
  message.speed_um_s = settings.reversal.speed_um_s;
  message.ir_margin = settings.reversal.ir_margin;
  message.max_wheel_um_s = settings.max_wheel_um_s;
  message.sensor_period_ms = settings.sensor_period_ms;
  message.robot_id = settings.robot_id;
  message.half_wheel_base_um = settings.half_wheel_base_um;
  return message;
}

void stage(const SetProgram& message, CoreSettings& settings) {
  if (message.slot < kSlots) {
    settings.programs[message.slot] = message.hash;
  }
}

void stage(const SetLight& message, CoreSettings& settings) {
  settings.light.count = message.count;
  settings.light.reading = static_cast<dynamics::LightReading>(message.reading);
  settings.light.hysteresis = message.hysteresis;
  for (uint8_t i = 0; i < kSlots; ++i) {
    settings.light.bands[i].low = message.low[i];
    settings.light.bands[i].high = message.high[i];
    settings.light.bands[i].slot = message.slot[i];
  }
}

void stage(const SetMotion& message, CoreSettings& settings) {
  settings.reversal.enabled = message.reversal != 0;
  settings.reversal.distance_um = message.distance_um;
  settings.reversal.speed_um_s = message.speed_um_s;
  settings.reversal.ir_margin = message.ir_margin;
  settings.max_wheel_um_s = message.max_wheel_um_s;
  settings.sensor_period_ms = message.sensor_period_ms;
  settings.robot_id = message.robot_id;
  settings.half_wheel_base_um = message.half_wheel_base_um;
}

uint16_t configCrc(const CoreSettings& settings) {
  FieldCrc crc;
  for (uint8_t slot = 0; slot < kSlots; ++slot) {
    const SetProgram program = programMessage(settings, slot);
    SetProgram::fields(program, crc);
  }
  const SetLight light = lightMessage(settings);
  SetLight::fields(light, crc);
  const SetMotion motion = motionMessage(settings);
  SetMotion::fields(motion, crc);
  return crc.value() == 0 ? 1 : crc.value();
}

ConfigFault firstFault(const CoreSettings& settings) {
  const int32_t limit = settings.max_wheel_um_s;
  if (limit <= 0 || limit > kFastestWheelUmS || settings.half_wheel_base_um <= 0 ||
      settings.half_wheel_base_um > kLargestHalfWheelBaseUm || settings.sensor_period_ms == 0 ||
      settings.sensor_period_ms > kLongestSensorPeriodMs) {
    return kBadLimits;
  }
  if (!dynamics::isValid(settings.light)) {
    return kBadBands;
  }
  const dynamics::ReversalSettings& reversal = settings.reversal;
  if (reversal.enabled && (reversal.speed_um_s <= 0 || reversal.speed_um_s > limit ||
                           reversal.distance_um > kLongestReversalUm)) {
    return kBadReversal;
  }
  return kNoFault;
}

}  // namespace wire
}  // namespace lab
