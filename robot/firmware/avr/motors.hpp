#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// Timer 0 in fast PWM at 3.9 kHz; both motors off, driver in standby.
void startMotors();

/// Signed duty -255..255. A wheel of 0 coasts; both 0: the driver goes to standby.
void setMotors(int16_t left, int16_t right);

/// Motors off at once, also where nothing works any more.
void cutMotors();

}  // namespace avr
}  // namespace lab
