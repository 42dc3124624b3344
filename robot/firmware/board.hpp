#pragma once

#include <stdint.h>

namespace lab {
namespace firmware {

/// What the program needs from the electronics: the chip's on a robot, a model of them in the
/// simulator.
class Board {
 public:
  /// Sets both motors, signed duty -255..255. Both 0: the driver goes to standby.
  virtual void setMotors(int16_t left, int16_t right) = 0;

  /// Queues a whole frame for the line, or nothing if there is no room for it. Never waits.
  virtual bool send(const uint8_t* bytes, uint8_t size) = 0;

  /// Whether nothing is queued (the last byte may still be under way).
  virtual bool lineIdle() const = 0;

  /// The EEPROM, kStoreSize bytes or more. A write takes 3.4 ms; one more before it is finished
  /// waits for it.
  virtual uint8_t readStore(uint16_t address) const = 0;
  virtual void writeStore(uint16_t address, uint8_t byte) = 0;

  /// Whether a write is still under way.
  virtual bool storeBusy() const { return false; }

  /// Smallest free RAM between stack and data since boot, bytes.
  virtual uint16_t stackLeft() const = 0;

 protected:
  ~Board() = default;
};

}  // namespace firmware
}  // namespace lab
