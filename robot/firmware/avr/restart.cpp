#include "robot/firmware/avr/restart.hpp"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>
#include <util/atomic.h>

#include "robot/firmware/avr/motors.hpp"
#include "robot/wire/messages.hpp"

extern uint8_t _end;     // end of the data, from the linker
extern uint8_t __stack;  // the last byte of RAM

namespace {

constexpr uint8_t kStackFill = 0xC5;              // fills the free RAM, to measure the stack
constexpr uint32_t kWatchdogMark = 0x1DEADD06UL;  // an unlikely value of RAM at power-on

// kWatchdogMark after a restart by the watchdog's interrupt. Not cleared at the start: survives a
// restart without reset.
uint32_t watchdog_mark __attribute__((section(".noinit")));
// MCUSR at the start. Not cleared: saveResetCause() sets it before .bss is cleared.
uint8_t reset_flags __attribute__((section(".noinit")));

}  // namespace

// Runs before the data are initialised and before main(). Saves the reset cause, switches off a
// watchdog that a reset left on (it would reset again within 16 ms), and fills the free RAM with a
// pattern for stackLeft().
extern "C" void saveResetCause() __attribute__((naked, used, section(".init3")));
void saveResetCause() {
  reset_flags = MCUSR;
  MCUSR = 0;
  wdt_disable();
  for (uint8_t* at = &_end; at <= &__stack; ++at) {
    *at = kStackFill;
  }
}

namespace lab {
namespace avr {

uint8_t resetCause() {
  const bool by_watchdog = watchdog_mark == kWatchdogMark;
  watchdog_mark = 0;
  if ((reset_flags & 1U << PORF) != 0) {
    return wire::kResetPower;
  }
  if ((reset_flags & 1U << BORF) != 0) {
    return wire::kResetBrownOut;
  }
  if ((reset_flags & 1U << WDRF) != 0) {
    return wire::kResetWatchdog;
  }
  if ((reset_flags & 1U << EXTRF) != 0) {
    return wire::kResetPin;
  }
  return by_watchdog ? wire::kResetWatchdog : wire::kResetUnknown;
}

void startWatchdog() {
#ifdef LAB_WATCHDOG_RESET
  wdt_enable(WDTO_250MS);
#else
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    wdt_reset();
    WDTCSR = 1U << WDCE | 1U << WDE;   // allows changes for four cycles
    WDTCSR = 1U << WDIE | 1U << WDP2;  // interrupt only, 250 ms
  }
#endif
}

void feedWatchdog() { wdt_reset(); }

uint16_t stackLeft() {
  const uint8_t* at = &_end;
  while (*at == kStackFill) {
    ++at;
  }
  return static_cast<uint16_t>(at - &_end);
}

}  // namespace avr
}  // namespace lab

#ifndef LAB_WATCHDOG_RESET
// Never returns, so no registers are saved; only the register that the compiler assumes to be zero
// must be cleared.
ISR(WDT_vect, ISR_NAKED) {
  asm volatile("clr __zero_reg__");
  lab::avr::cutMotors();
  watchdog_mark = kWatchdogMark;
  asm volatile("jmp 0");
}
#endif
