#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// Timer 0 in fast PWM at 3.9 kHz; both motors off, driver in standby.
void startMotors();

/// Sets the signed duties -255..255. With 0 a wheel coasts; with both 0 the driver is in standby.
void setMotors(int16_t left, int16_t right);

/// Switches the motors off at once. Usable in the watchdog interrupt.
void cutMotors();

}  // namespace avr
}  // namespace lab
