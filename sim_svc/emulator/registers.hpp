/// Addresses and bits of the ATmega328P that the emulator reads (data sheet, "Register Summary").
#pragma once

#include <cstdint>

namespace lab::emulator {

inline constexpr std::uint16_t kPortB = 0x25;
inline constexpr std::uint16_t kDdrB = 0x24;
inline constexpr std::uint16_t kPortD = 0x2B;
inline constexpr std::uint16_t kDdrD = 0x2A;
inline constexpr std::uint16_t kEecr = 0x3F;
inline constexpr std::uint16_t kEearLow = 0x41;
inline constexpr std::uint16_t kEearHigh = 0x42;
inline constexpr std::uint16_t kTccr0A = 0x44;
inline constexpr std::uint16_t kTccr0B = 0x45;
inline constexpr std::uint16_t kOcr0A = 0x47;
inline constexpr std::uint16_t kOcr0B = 0x48;
inline constexpr std::uint16_t kMcusr = 0x54;
inline constexpr std::uint16_t kStackLow = 0x5D;
inline constexpr std::uint16_t kStackHigh = 0x5E;
inline constexpr std::uint16_t kUcsr0A = 0xC0;
inline constexpr std::uint16_t kUbrr0Low = 0xC4;
inline constexpr std::uint16_t kUbrr0High = 0xC5;

inline constexpr std::uint16_t kRamBegin = 0x100;
inline constexpr std::uint16_t kRamLast = 0x8FF;

inline constexpr unsigned kEepe = 1U << 1U;
inline constexpr unsigned kEempe = 1U << 2U;
inline constexpr unsigned kU2x0 = 1U << 1U;

}  // namespace lab::emulator
