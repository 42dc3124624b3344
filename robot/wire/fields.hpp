#pragma once

#include <stdint.h>
#include <string.h>

#include "robot/wire/frame.hpp"

namespace lab {
namespace wire {

// Integers have the same bytes in memory and on the wire, so that copying them is the shortest code
// for the chip.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the wire is little endian");

/// Writes the fields of a message one after the other, little endian, without padding.
class FieldWriter {
 public:
  explicit FieldWriter(uint8_t* bytes) : at_(bytes), begin_(bytes) {}

  void operator()(const uint8_t& value) { *at_++ = value; }
  void operator()(const uint16_t& value) { put(&value, sizeof value); }
  void operator()(const uint32_t& value) { put(&value, sizeof value); }
  void operator()(const int32_t& value) { put(&value, sizeof value); }

  template <uint8_t N>
  void counts10(const uint16_t (&values)[N]) {
    static_assert(N % 4 == 0, "four counts of 10 bits fill five bytes");
    for (uint8_t i = 0; i < N; i = static_cast<uint8_t>(i + 4)) {
      uint8_t high = 0;
      for (uint8_t j = 0; j < 4; ++j) {
        (*this)(static_cast<uint8_t>(values[i + j] & 0xFFU));
        high = static_cast<uint8_t>(high | (((values[i + j] >> 8) & 3U) << (2 * j)));
      }
      (*this)(high);
    }
  }

  uint8_t size() const { return static_cast<uint8_t>(at_ - begin_); }

 private:
  void put(const void* value, uint8_t size) {
    memcpy(at_, value, size);
    at_ += size;
  }

  uint8_t* at_;
  uint8_t* begin_;
};

/// Reads the fields of a message. The caller must have checked the size.
class FieldReader {
 public:
  explicit FieldReader(const uint8_t* bytes) : at_(bytes) {}

  void operator()(uint8_t& value) { value = *at_++; }
  void operator()(uint16_t& value) { get(&value, sizeof value); }
  void operator()(uint32_t& value) { get(&value, sizeof value); }
  void operator()(int32_t& value) { get(&value, sizeof value); }

  template <uint8_t N>
  void counts10(uint16_t (&values)[N]) {
    for (uint8_t i = 0; i < N; i = static_cast<uint8_t>(i + 4)) {
      const uint8_t* const low = at_;
      const uint8_t high = low[4];
      for (uint8_t j = 0; j < 4; ++j) {
        values[i + j] = static_cast<uint16_t>(low[j] | (((high >> (2 * j)) & 3U) << 8));
      }
      at_ += 5;
    }
  }

 private:
  void get(void* value, uint8_t size) {
    memcpy(value, at_, size);
    at_ += size;
  }

  const uint8_t* at_;
};

/// Adds up the sizes of the fields; usable at compile time.
class FieldSize {
 public:
  template <class Integer>
  constexpr void operator()(const Integer&) {
    size_ = static_cast<uint8_t>(size_ + sizeof(Integer));
  }
  template <uint8_t N>
  constexpr void counts10(const uint16_t (&)[N]) {
    size_ = static_cast<uint8_t>(size_ + N / 4 * 5);
  }
  constexpr uint8_t size() const { return size_; }

 private:
  uint8_t size_ = 0;
};

/// The size of a message's payload.
template <class Message>
constexpr uint8_t payloadSize() {
  Message message{};
  FieldSize size;
  Message::fields(message, size);
  return size.size();
}

/// Whether the fields of a message are on the wire in another order than in its struct.
template <class Message>
struct Reordered {
  static constexpr bool kValue = false;
};

/// Whether a message has the same bytes in memory and on the wire. The chip aligns nothing, so
/// there it is true for most messages, and copying them whole saves more than a kilobyte of flash.
template <class Message>
constexpr bool sameInMemory() {
#ifdef __AVR__
  return sizeof(Message) == payloadSize<Message>() && !Reordered<Message>::kValue;
#else
  return false;
#endif
}

/// Fills a frame with a message.
template <class Message>
void pack(const Message& message, uint8_t seq, Frame& frame) {
  static_assert(payloadSize<Message>() <= kMaxPayload, "the message is too long for a frame");
  frame.type = Message::kType;
  frame.seq = seq;
  if (sameInMemory<Message>()) {
    memcpy(frame.payload, &message, sizeof message);
    frame.size = sizeof message;
    return;
  }
  FieldWriter writer(frame.payload);
  Message::fields(message, writer);
  frame.size = writer.size();
}

/// Reads a message from a frame. Returns false if the frame has another type or length.
template <class Message>
bool unpack(const Frame& frame, Message& message) {
  if (frame.type != Message::kType || frame.size != payloadSize<Message>()) {
    return false;
  }
  if (sameInMemory<Message>()) {
    memcpy(&message, frame.payload, sizeof message);
    return true;
  }
  FieldReader reader(frame.payload);
  Message::fields(message, reader);
  return true;
}

}  // namespace wire
}  // namespace lab
