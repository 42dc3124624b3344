/// The behaviour of the motor driver TB6612FNG at the chip's pins.
#pragma once

#include <cstdint>

#include "sim_svc/emulator/chip.hpp"

namespace lab::emulator {

/// Signed duties from the registers of ports and timer 0. A wheel is driven with the pulse width if
/// the driver is not in standby and exactly one of the wheel's two direction pins is high. With
/// both high it brakes, with both low it coasts; its duty is then 0. A pin that is not an output is
/// low, because the board pulls the driver's inputs down.
///
/// The duty is the value of OCR0x; the pin is high for OCR0x + 1 of 256 counts.
[[nodiscard]] Duty motorDuty(const std::uint8_t* data);

/// Whether D10 switches the infrared emitters on.
[[nodiscard]] bool emittersOn(const std::uint8_t* data);

}  // namespace lab::emulator
