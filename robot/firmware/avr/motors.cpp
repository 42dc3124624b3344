#include "robot/firmware/avr/motors.hpp"

#include <avr/io.h>
#include <util/atomic.h>

#include "robot/firmware/avr/pins.hpp"

namespace lab {
namespace avr {
namespace {

void setPins(volatile uint8_t& port, uint8_t mask, bool high) {
  port = static_cast<uint8_t>(high ? port | mask : port & ~mask);
}

uint8_t size(int16_t duty) { return static_cast<uint8_t>(duty < 0 ? -duty : duty); }

}  // namespace

void cutMotors() {
  PORTB = static_cast<uint8_t>(PORTB & ~(kStandby | kBin2));
  PORTD = static_cast<uint8_t>(PORTD & ~(kAin1 | kAin2 | kBin1 | kPwmA | kPwmB));
  TCCR0A = 0;  // disconnects the timer from the pins
}

void startMotors() {
  cutMotors();
  DDRB = static_cast<uint8_t>(DDRB | kStandby | kBin2);
  DDRD = static_cast<uint8_t>(DDRD | kAin1 | kAin2 | kBin1 | kPwmA | kPwmB);
  TIMSK0 = 0;
  OCR0A = 0;
  OCR0B = 0;
  TCCR0A = 1U << WGM01 | 1U << WGM00;
  TCCR0B = 1U << CS01;  // clock / 8 / 256
}

// At OCR = n the pin is high for n + 1 of 256 counts, so 0 is not off. For duty 0, both direction
// pins are therefore low and the timer is disconnected from the PWM pin.
void setMotors(int16_t left, int16_t right) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {  // ports are also written by the converter's interrupt
    OCR0B = size(left);
    OCR0A = size(right);
    uint8_t control = 1U << WGM01 | 1U << WGM00;
    if (left != 0) {
      control = static_cast<uint8_t>(control | 1U << COM0B1);
    }
    if (right != 0) {
      control = static_cast<uint8_t>(control | 1U << COM0A1);
    }
    TCCR0A = control;
    setPins(PORTD, kAin1, left > 0);
    setPins(PORTD, kAin2, left < 0);
    setPins(PORTD, kBin1, right > 0);
    setPins(PORTB, kBin2, right < 0);
    setPins(PORTB, kStandby, left != 0 || right != 0);
  }
}

}  // namespace avr
}  // namespace lab
