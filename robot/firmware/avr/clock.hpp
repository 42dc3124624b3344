#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// The robot's clock: timer 1 counts microseconds, 1000 to the millisecond.
void startClock();

/// Milliseconds since startClock(); wraps around.
uint32_t nowMs();

/// An instant as it can be taken inside an interrupt: the low bits of the milliseconds and the
/// microseconds in them.
struct Instant {
  uint16_t ms;
  uint16_t us;
};

/// Now. Interrupts must be off.
Instant nowWithInterruptsOff();

}  // namespace avr
}  // namespace lab
