#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

constexpr uint32_t kBaud = LAB_BAUD;

/// Size of the receive queue, which holds one byte less. A power of two, so that indices wrap by a
/// mask.
constexpr uint8_t kReceiveQueue = 64;

/// Starts the serial line: kBaud, 8N1, interrupt driven.
void startUart();

/// A received byte. The time is that of its reception for a 0 (the end of a frame), and the present
/// time for other bytes.
struct Received {
  uint8_t byte;
  uint32_t ms;
  uint16_t us;
};

/// Takes the oldest received byte. Returns false if there is none.
bool receiveByte(uint32_t now_ms, Received& received);

/// Whether there are received bytes. May be called with interrupts off.
bool bytesWait();

/// Queues all bytes, or none of them and returns false.
bool sendBytes(const uint8_t* bytes, uint8_t size);

/// Whether the send queue is empty.
bool nothingQueued();

/// Bytes lost since the last call, because the line or the queue overran.
uint16_t takeOverruns();

}  // namespace avr
}  // namespace lab
