#pragma once

#include <stdint.h>

namespace lab {
namespace firmware {

/// The electronics as the firmware uses them: real on the chip, simulated on a host.
class Board {
 public:
  /// Sets both motors, signed duty -255..255. Both 0: the driver goes to standby.
  virtual void setMotors(int16_t left, int16_t right) = 0;

  /// Queues a whole frame for the line, or nothing and returns false if it does not fit. Never
  /// waits.
  virtual bool send(const uint8_t* bytes, uint8_t size) = 0;

  /// Whether the queue is empty (the last byte may still be on the line).
  virtual bool lineIdle() const = 0;

  /// The EEPROM, at least kStoreSize bytes. A write takes 3.4 ms; the next write waits until it is
  /// finished.
  virtual uint8_t readStore(uint16_t address) const = 0;
  virtual void writeStore(uint16_t address, uint8_t byte) = 0;

  /// Whether a write is in progress.
  virtual bool storeBusy() const { return false; }

  /// Smallest free RAM between stack and data since boot [bytes].
  virtual uint16_t stackLeft() const = 0;

 protected:
  ~Board() = default;
};

}  // namespace firmware
}  // namespace lab
