#pragma once

#include <stdint.h>

namespace lab {
namespace avr {

constexpr uint32_t kBaud = LAB_BAUD;

/// How many bytes wait for the program at most (one less). A power of two, so that an index wraps
/// by a mask.
constexpr uint8_t kReceiveQueue = 64;

/// The serial line at kBaud, 8N1, driven by interrupts.
void startUart();

/// A byte that came in. For a 0, the end of a frame, also when; for any other byte just now.
struct Received {
  uint8_t byte;
  uint32_t ms;
  uint16_t us;
};

/// Takes the oldest byte that came in; false: there is none.
bool receiveByte(uint32_t now_ms, Received& received);

/// Whether bytes wait. Also callable with interrupts off.
bool bytesWait();

/// Queues all bytes, or none of them.
bool sendBytes(const uint8_t* bytes, uint8_t size);

/// Whether nothing is queued.
bool nothingQueued();

/// Bytes lost since the last call, because the line or the queue overran.
uint16_t takeOverruns();

}  // namespace avr
}  // namespace lab
