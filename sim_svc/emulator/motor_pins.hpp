/// What the TB6612FNG makes of the chip's pins.
#pragma once

#include <cstdint>

#include "sim_svc/emulator/chip.hpp"

namespace lab::emulator {

/// Signed duties from the registers of ports and timer 0: the pulse width where the driver is out
/// of standby and exactly one of a wheel's two direction pins is high; both high brakes, both low
/// lets it run out, and either way the wheel is not driven. A pin that is no output is low: the
/// board pulls the driver's inputs down.
///
/// The duty is the number in OCR0x; the pin is high for OCR + 1 of 256 counts.
[[nodiscard]] Duty motorDuty(const std::uint8_t* data);

/// Whether D10 lights the infrared emitters.
[[nodiscard]] bool emittersOn(const std::uint8_t* data);

}  // namespace lab::emulator
