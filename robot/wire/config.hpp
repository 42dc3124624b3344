#pragma once

#include <stdint.h>

#include "robot/dynamics/robot_core.hpp"
#include "robot/wire/messages.hpp"

namespace lab {
namespace wire {

/// The settings of a robot's core as the six messages that stage them.
SetProgram programMessage(const dynamics::CoreSettings& settings, uint8_t slot);
SetLight lightMessage(const dynamics::CoreSettings& settings);
SetMotion motionMessage(const dynamics::CoreSettings& settings);

/// Staging a message: copies it into the settings. Nothing is checked; see firstFault().
void stage(const SetProgram& message, dynamics::CoreSettings& settings);
void stage(const SetLight& message, dynamics::CoreSettings& settings);
void stage(const SetMotion& message, dynamics::CoreSettings& settings);

/// CRC-16 over the payloads of the six messages, slots in order, then light, then motion: what
/// APPLY and ORDER compare. Never 0, which means no settings.
uint16_t configCrc(const dynamics::CoreSettings& settings);

/// Why a robot with these wheels cannot run the settings.
enum ConfigFault : uint8_t {
  kNoFault = 0,
  kBadKind = 1,      ///< a program kind that does not exist
  kBadTime = 2,      ///< a hold, run or tumble of 0 or beyond the longest
  kTooFast = 3,      ///< a wheel speed beyond the fastest
  kBadBands = 4,     ///< light bands that overlap, are empty or leave the converter's range
  kBadReversal = 5,  ///< a reversal too fast or beyond 4 m
  kBadLimits = 6,    ///< fastest wheel or sensor period out of range
};

/// The first fault of the settings; a robot refuses to apply what has one.
ConfigFault firstFault(const dynamics::CoreSettings& settings);

}  // namespace wire
}  // namespace lab
