#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// Starts the robot's clock: timer 1 counts microseconds from 0 to 999.
void startClock();

/// Milliseconds since startClock(); wraps around.
uint32_t nowMs();

/// A time as it can be read inside an interrupt: the low 16 bits of the milliseconds, and the
/// microseconds within the millisecond.
struct Instant {
  uint16_t ms;
  uint16_t us;
};

/// The present time. Interrupts must be off.
Instant nowWithInterruptsOff();

}  // namespace avr
}  // namespace lab
