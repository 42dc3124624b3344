#pragma once

#include <stdint.h>

#include "robot/dynamics/robot_core.hpp"
#include "robot/wire/messages.hpp"

namespace lab {
namespace wire {

/// Converts the settings of a robot's core into the six messages that stage them.
SetProgram programMessage(const dynamics::CoreSettings& settings, uint8_t slot);
SetLight lightMessage(const dynamics::CoreSettings& settings);
SetMotion motionMessage(const dynamics::CoreSettings& settings);

/// Copies a message into the settings, without checks; see firstFault().
void stage(const SetProgram& message, dynamics::CoreSettings& settings);
void stage(const SetLight& message, dynamics::CoreSettings& settings);
void stage(const SetMotion& message, dynamics::CoreSettings& settings);

/// The CRC that APPLY and ORDER compare: CRC-16 over the payloads of the six messages (programs in
/// the order of the slots, light, motion). It is never 0, which means no settings.
uint16_t configCrc(const dynamics::CoreSettings& settings);

/// Reasons why a robot cannot run the settings.
enum ConfigFault : uint8_t {
  kNoFault = 0,
  kBadBands = 1,     ///< see isValid(LightSettings)
  kBadReversal = 2,  ///< speed not above 0 or above the maximum, or longer than 4 m
  kBadLimits = 3,    ///< largest wheel speed, wheel base or sensor period out of range
};

/// The first fault of the settings. A robot refuses to apply settings with a fault.
ConfigFault firstFault(const dynamics::CoreSettings& settings);

}  // namespace wire
}  // namespace lab
