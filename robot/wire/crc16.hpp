#pragma once

#include <stdint.h>

namespace lab {
namespace wire {

/// CRC-16/X-25: polynomial 0x1021 reflected, initial value and final XOR 0xFFFF; check value for
/// "123456789" is 0x906E. Without the final XOR, a frame with an appended zero would be accepted.
class Crc16 {
 public:
  void add(uint8_t byte) {
    // The bytewise form of the reflected polynomial 0x8408, without a table.
    const uint8_t low = static_cast<uint8_t>(byte ^ (state_ & 0xFFU));
    const uint8_t mixed = static_cast<uint8_t>(low ^ (low << 4));
    state_ = static_cast<uint16_t>(((static_cast<uint16_t>(mixed) << 8) | (state_ >> 8)) ^
                                   static_cast<uint8_t>(mixed >> 4) ^
                                   (static_cast<uint16_t>(mixed) << 3));
  }
  uint16_t value() const { return static_cast<uint16_t>(~state_); }

 private:
  uint16_t state_ = 0xFFFF;
};

/// The CRC-16/X-25 of `size` bytes.
inline uint16_t crc16(const uint8_t* bytes, uint16_t size) {
  Crc16 crc;
  for (uint16_t i = 0; i < size; ++i) {
    crc.add(bytes[i]);
  }
  return crc.value();
}

}  // namespace wire
}  // namespace lab
