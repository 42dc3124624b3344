#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

/// Why the chip started, as found before main() (wire::ResetCause).
uint8_t resetCause();

/// Starts the watchdog, 250 ms. As built by default a bite does not reset the chip, because the
/// stock bootloader of the Pro Mini never leaves a watchdog reset: the interrupt cuts the motors
/// and starts the program from its beginning. Built with LAB_WATCHDOG_RESET it is a true reset.
void startWatchdog();
void feedWatchdog();

/// Smallest free RAM between data and stack since the start, bytes.
uint16_t stackLeft();

}  // namespace avr
}  // namespace lab
