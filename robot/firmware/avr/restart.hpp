#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// Why the chip started (wire::ResetCause).
uint8_t resetCause();

/// Starts the watchdog with a timeout of 250 ms. By default the timeout does not reset the chip,
/// because the stock bootloader of the Pro Mini hangs after a watchdog reset. Instead an interrupt
/// switches off the motors and restarts the program. With LAB_WATCHDOG_RESET the chip is reset.
void startWatchdog();
void feedWatchdog();

/// Smallest free RAM between data and stack since the start [bytes].
uint16_t stackLeft();

}  // namespace avr
}  // namespace lab
