#pragma once

#include <avr/io.h>

// The connections of the pins (docs/robot.md). For another board, change this file.

namespace lab {
namespace avr {

// Left motor: channel A of the TB6612FNG.
constexpr uint8_t kAin1 = 1U << PD2;  ///< D2
constexpr uint8_t kAin2 = 1U << PD4;  ///< D4
constexpr uint8_t kPwmA = 1U << PD5;  ///< D5, OC0B

// Right motor: channel B.
constexpr uint8_t kPwmB = 1U << PD6;  ///< D6, OC0A
constexpr uint8_t kBin1 = 1U << PD7;  ///< D7
constexpr uint8_t kBin2 = 1U << PB0;  ///< D8, on port B

constexpr uint8_t kStandby = 1U << PB1;     ///< D9: high lets the driver work
constexpr uint8_t kIrEmitters = 1U << PB2;  ///< D10: high lights the six emitters

// Channels of the converter: the six infrared sensors A0 to A5, then the two light sensors.
constexpr uint8_t kFrontLightChannel = 6;  ///< A6
constexpr uint8_t kBackLightChannel = 7;   ///< A7

}  // namespace avr
}  // namespace lab
