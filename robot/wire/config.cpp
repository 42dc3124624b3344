#include "robot/wire/config.hpp"

#include "robot/dynamics/exponential.hpp"
#include "robot/wire/crc16.hpp"

namespace lab {
namespace wire {
namespace {

using dynamics::CoreSettings;
using dynamics::kSlots;
using dynamics::ProgramParams;

constexpr uint32_t kLongestHoldMs = 3600000UL;
constexpr uint32_t kLongestReversalUm = 4000000UL;
constexpr int32_t kFastestWheelUmS = 5000000L;
constexpr uint16_t kLongestSensorPeriodMs = 1000;

/// Computes a CRC over the fields in their form on the wire.
class FieldCrc {
 public:
  void operator()(const uint8_t& value) { crc_.add(value); }
  void operator()(const uint16_t& value) { add(&value, sizeof value); }
  void operator()(const uint32_t& value) { add(&value, sizeof value); }
  void operator()(const int32_t& value) { add(&value, sizeof value); }
  uint16_t value() const { return crc_.value(); }

 private:
  void add(const void* bytes, uint8_t size) {
    for (uint8_t i = 0; i < size; ++i) {
      crc_.add(static_cast<const uint8_t*>(bytes)[i]);
    }
  }

  Crc16 crc_;
};

bool within(int32_t value, int32_t limit) { return value <= limit && value >= -limit; }

int32_t magnitude(int32_t value) { return value < 0 ? -value : value; }

// Checks both summands first, so that the sum cannot overflow.
bool sumWithin(int32_t a, int32_t b, int32_t limit) {
  return within(a, limit) && within(b, limit) && magnitude(a) + magnitude(b) <= limit;
}

bool validTime(uint32_t ms) { return ms > 0 && ms <= kLongestHoldMs; }

ConfigFault faultOf(const ProgramParams& params, int32_t limit) {
  switch (params.kind) {
    case dynamics::kNone:
      return kNoFault;
    case dynamics::kAbp:
    case dynamics::kNoisyAbp:
    case dynamics::kBp:
      if (!validTime(params.hold_ms)) {
        return kBadTime;
      }
      return sumWithin(params.speed_um_s, params.amplitude_um_s, limit) ? kNoFault : kTooFast;
    case dynamics::kRtp:
      if (!validTime(params.tumble_ms) || params.mean_run_us == 0 ||
          params.mean_run_us > dynamics::kLongestMeanUs) {
        return kBadTime;
      }
      return within(params.speed_um_s, limit) && within(params.tumble_amplitude_um_s, limit)
                 ? kNoFault
                 : kTooFast;
    case dynamics::kWheels:
      return within(params.left_um_s, limit) && within(params.right_um_s, limit) ? kNoFault
                                                                                 : kTooFast;
  }
  return kBadKind;
}

}  // namespace

SetProgram programMessage(const CoreSettings& settings, uint8_t slot) {
  const ProgramParams& params = settings.programs[slot];
  SetProgram message;
  message.slot = slot;
  message.kind = params.kind;
  message.speed_um_s = params.speed_um_s;
  message.amplitude_um_s = params.amplitude_um_s;
  message.hold_ms = params.hold_ms;
  message.mean_run_us = params.mean_run_us;
  message.tumble_ms = params.tumble_ms;
  message.tumble_amplitude_um_s = params.tumble_amplitude_um_s;
  message.left_um_s = params.left_um_s;
  message.right_um_s = params.right_um_s;
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
  return message;
}

void stage(const SetProgram& message, CoreSettings& settings) {
  if (message.slot >= kSlots) {
    return;
  }
  ProgramParams& params = settings.programs[message.slot];
  params.kind = static_cast<dynamics::ProgramKind>(message.kind);
  params.speed_um_s = message.speed_um_s;
  params.amplitude_um_s = message.amplitude_um_s;
  params.hold_ms = message.hold_ms;
  params.mean_run_us = message.mean_run_us;
  params.tumble_ms = message.tumble_ms;
  params.tumble_amplitude_um_s = message.tumble_amplitude_um_s;
  params.left_um_s = message.left_um_s;
  params.right_um_s = message.right_um_s;
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
  if (limit <= 0 || limit > kFastestWheelUmS || settings.sensor_period_ms == 0 ||
      settings.sensor_period_ms > kLongestSensorPeriodMs) {
    return kBadLimits;
  }
  for (uint8_t slot = 0; slot < kSlots; ++slot) {
    const ConfigFault fault = faultOf(settings.programs[slot], limit);
    if (fault != kNoFault) {
      return fault;
    }
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
