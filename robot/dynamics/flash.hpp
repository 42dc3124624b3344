#pragma once

#include <stdint.h>

// On the chip, constant tables are copied into the 2 kB of RAM unless they are placed in flash and
// read with a special instruction. This is the only difference between chip and host in this
// folder.
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
inline int32_t readFlash(const int32_t* entry) {
#ifdef __AVR__
  return static_cast<int32_t>(pgm_read_dword(entry));
#else
  return *entry;
#endif
}

}  // namespace dynamics
}  // namespace lab
