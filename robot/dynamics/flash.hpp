#pragma once

#include <stdint.h>

// A constant table costs the robot's 2 kB of RAM unless it is placed in flash and read with its own
// instruction. This is the one place where the two machines differ.
#ifdef __AVR__
#include <avr/pgmspace.h>
#define LAB_IN_FLASH PROGMEM
#else
#define LAB_IN_FLASH
#endif

namespace lab {
namespace dynamics {

/// Reads one entry of a table declared LAB_IN_FLASH.
inline uint16_t readFlash(const uint16_t* entry) {
#ifdef __AVR__
  return pgm_read_word(entry);
#else
  return *entry;
#endif
}

}  // namespace dynamics
}  // namespace lab
