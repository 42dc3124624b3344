#pragma once

#include <stdint.h>

namespace lab {
namespace wire {

/// The version in every frame. Frames of other versions are counted and dropped.
constexpr uint8_t kProtocolVersion = 2;

/// The longest payload. The whole frame is then at most 46 bytes before stuffing, so that COBS
/// never needs a second 254-byte block and costs exactly one byte.
constexpr uint8_t kMaxPayload = 40;
constexpr uint8_t kHeaderSize = 4;  ///< version, type, seq, payload length
constexpr uint8_t kCrcSize = 2;
constexpr uint8_t kMaxRaw = kHeaderSize + kMaxPayload + kCrcSize;
/// Bytes on the wire beyond the payload: 0, one byte of stuffing, header, CRC, 0.
constexpr uint8_t kFrameOverhead = kHeaderSize + kCrcSize + 3;
constexpr uint8_t kMaxFrame = kMaxPayload + kFrameOverhead;

/// One frame after decoding, or before encoding.
struct Frame {
  uint8_t type = 0;
  uint8_t seq = 0;
  uint8_t size = 0;  ///< of the payload
  uint8_t payload[kMaxPayload] = {};
};

/// Writes 0, COBS(version type seq size payload crc_low crc_high), 0 into `bytes` (at least
/// kMaxFrame) and returns the number of bytes. frame.size must be at most kMaxPayload.
///
/// The 0 in front separates the frame from noise that the line carried before.
uint8_t encode(const Frame& frame, uint8_t* bytes);

/// Counts of a decoder since its construction. They wrap around.
struct DecoderCounts {
  uint16_t frames = 0;     ///< accepted
  uint16_t crc = 0;        ///< wrong CRC
  uint16_t malformed = 0;  ///< too short, too long, or lengths that contradict each other
  uint16_t version = 0;    ///< well-formed frames of another protocol version
};

/// Finds frames in a stream of bytes. It stores one frame and resynchronises at the next 0.
class Decoder {
 public:
  /// Takes one byte. Returns true if it completes a frame, which frame() returns until the next
  /// call.
  bool push(uint8_t byte);

  const Frame& frame() const { return frame_; }
  const DecoderCounts& counts() const { return counts_; }

  /// The version of the last well-formed frame of another protocol version; 0: none.
  uint8_t foreignVersion() const { return foreign_version_; }

  /// Forgets a half-received frame, as after an interruption of the line.
  void reset();

 private:
  bool finish();

  uint8_t raw_[kMaxRaw] = {};
  uint8_t used_ = 0;
  uint8_t block_ = 0;      ///< bytes left in the COBS block, 0: the next byte is a code
  bool zero_due_ = false;  ///< the data continue with a zero before the next block
  bool broken_ = false;    ///< ignore everything until the next 0
  bool begun_ = false;     ///< there were bytes since the last 0
  uint8_t foreign_version_ = 0;
  Frame frame_;
  DecoderCounts counts_;
};

}  // namespace wire
}  // namespace lab
