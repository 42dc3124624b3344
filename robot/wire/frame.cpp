#include "robot/wire/frame.hpp"

#include "robot/wire/crc16.hpp"

namespace lab {
namespace wire {
uint8_t encode(const Frame& frame, uint8_t* bytes) {
  uint8_t* const raw = bytes + 2;  // after the first 0 and the first COBS code
  raw[0] = kProtocolVersion;
  raw[1] = frame.type;
  raw[2] = frame.seq;
  raw[3] = frame.size;
  uint8_t used = kHeaderSize;
  for (uint8_t i = 0; i < frame.size; ++i) {
    raw[used++] = frame.payload[i];
  }
  const uint16_t sum = crc16(raw, used);
  raw[used++] = static_cast<uint8_t>(sum & 0xFFU);
  raw[used++] = static_cast<uint8_t>(sum >> 8);

  // COBS in place, from the end: each zero is replaced by the distance to the next zero, which fits
  // into a byte because there are fewer than 254 bytes.
  uint8_t distance = 1;
  for (uint8_t i = used; i > 0; --i) {
    uint8_t& byte = raw[i - 1];
    if (byte == 0) {
      byte = distance;
      distance = 0;
    }
    ++distance;
  }
  bytes[0] = 0;
  bytes[1] = distance;
  raw[used] = 0;
  return static_cast<uint8_t>(used + 3);
}

void Decoder::reset() {
  used_ = 0;
  block_ = 0;
  zero_due_ = false;
  broken_ = false;
  begun_ = false;
}

bool Decoder::push(uint8_t byte) {
  if (byte == 0) {
    const bool complete = begun_ && finish();
    reset();
    return complete;
  }
  begun_ = true;
  if (broken_) {
    return false;
  }
  if (block_ == 0) {  // a COBS code: ends a block, which implies a zero, and begins a new one
    if (zero_due_) {
      if (used_ == kMaxRaw) {
        broken_ = true;
        return false;
      }
      raw_[used_++] = 0;
    }
    block_ = static_cast<uint8_t>(byte - 1U);
    zero_due_ = true;
    return false;
  }
  --block_;
  if (used_ == kMaxRaw) {
    broken_ = true;
    return false;
  }
  raw_[used_++] = byte;
  return false;
}

bool Decoder::finish() {
  if (broken_ || block_ != 0 || used_ < kHeaderSize + kCrcSize) {
    ++counts_.malformed;
    return false;
  }
  const uint8_t size = static_cast<uint8_t>(used_ - kHeaderSize - kCrcSize);
  const uint16_t sum = static_cast<uint16_t>(raw_[used_ - 2] | (raw_[used_ - 1] << 8));
  if (crc16(raw_, static_cast<uint16_t>(used_ - kCrcSize)) != sum) {
    ++counts_.crc;
    return false;
  }
  if (raw_[0] != kProtocolVersion) {
    foreign_version_ = raw_[0];
    ++counts_.version;
    return false;
  }
  if (raw_[3] != size) {
    ++counts_.malformed;
    return false;
  }
  frame_.type = raw_[1];
  frame_.seq = raw_[2];
  frame_.size = size;
  for (uint8_t i = 0; i < size; ++i) {
    frame_.payload[i] = raw_[kHeaderSize + i];
  }
  ++counts_.frames;
  return true;
}

}  // namespace wire
}  // namespace lab
