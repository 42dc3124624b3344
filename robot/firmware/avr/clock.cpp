#include "robot/firmware/avr/clock.hpp"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

namespace lab {
namespace avr {
namespace {

static_assert(F_CPU == 8000000UL, "the prescaler of 8 makes microseconds of 8 MHz");
constexpr uint16_t kMicrosecondsPerMs = 1000;

volatile uint32_t milliseconds = 0;

}  // namespace

void startClock() {
  milliseconds = 0;
  TIMSK1 = 0;
  TCCR1B = 0;
  TCCR1A = 0;
  TCNT1 = 0;
  OCR1A = kMicrosecondsPerMs - 1;
  TIFR1 = 1U << OCF1A;
  TIMSK1 = 1U << OCIE1A;
  TCCR1B = 1U << WGM12 | 1U << CS11;  // count to OCR1A, clock / 8
}

uint32_t nowMs() {
  uint32_t now;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { now = milliseconds; }
  return now;
}

Instant nowWithInterruptsOff() {
  Instant now;
  now.us = TCNT1;
  now.ms = static_cast<uint16_t>(milliseconds);
  // The counter has begun a new millisecond, but its interrupt is still pending.
  if ((TIFR1 & 1U << OCF1A) != 0 && now.us < kMicrosecondsPerMs / 2) {
    ++now.ms;
  }
  return now;
}

}  // namespace avr
}  // namespace lab

ISR(TIMER1_COMPA_vect) { lab::avr::milliseconds = lab::avr::milliseconds + 1; }
