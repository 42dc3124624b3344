/// Frames and bytes for the tests of robot/wire/, and an independent implementation of the framing:
/// a bitwise CRC and a forward COBS that share no code with robot/wire/frame.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "robot/wire/frame.hpp"

namespace lab::wire {

using Bytes = std::vector<std::uint8_t>;

/// The frame written by the codec under test, into a buffer of exactly the promised size.
inline Bytes encoded(const Frame& frame) {
  Bytes bytes(static_cast<std::size_t>(frame.size) + kFrameOverhead);
  bytes.resize(encode(frame, bytes.data()));
  return bytes;
}

/// All frames that a decoder finds in the bytes.
inline std::vector<Frame> received(Decoder& decoder, const Bytes& bytes) {
  std::vector<Frame> frames;
  for (const std::uint8_t byte : bytes) {
    if (decoder.push(byte)) {
      frames.push_back(decoder.frame());
    }
  }
  return frames;
}

inline bool operator==(const Frame& a, const Frame& b) {
  return a.type == b.type && a.seq == b.seq && a.size == b.size &&
         std::equal(a.payload, a.payload + a.size, b.payload);
}

inline Frame frameOf(std::uint8_t type, std::uint8_t seq, const Bytes& payload) {
  Frame frame;
  frame.type = type;
  frame.seq = seq;
  frame.size = static_cast<std::uint8_t>(payload.size());
  std::copy(payload.begin(), payload.end(), frame.payload);
  return frame;
}

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// CRC-16/X-25 bit by bit.
inline std::uint16_t crcByTheBook(const Bytes& bytes) {
  unsigned state = 0xFFFF;
  for (const unsigned byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool carry = ((state ^ (byte >> bit)) & 1U) != 0;
      state = (state >> 1) ^ (carry ? 0x8408U : 0U);
    }
  }
  return static_cast<std::uint16_t>(state ^ 0xFFFFU);
}

/// 0, COBS(raw), 0: each run up to a zero is preceded by its length plus one.
inline Bytes stuffed(const Bytes& raw) {
  Bytes out{0};
  Bytes run;
  const auto flush = [&] {
    out.push_back(static_cast<std::uint8_t>(run.size() + 1));
    out = out + run;
    run.clear();
  };
  for (const std::uint8_t byte : raw) {
    if (byte == 0) {
      flush();
    } else {
      run.push_back(byte);
    }
  }
  flush();
  out.push_back(0);
  return out;
}

/// Encodes raw bytes with their CRC, including contents that no sender would produce.
inline Bytes sealed(const Bytes& raw) {
  const std::uint16_t crc = crcByTheBook(raw);
  return stuffed(
      raw + Bytes{static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8)});
}

inline Bytes encodedByTheBook(const Frame& frame) {
  return sealed(Bytes{2, frame.type, frame.seq, frame.size} +
                Bytes(frame.payload, frame.payload + frame.size));
}

/// Reproducible random numbers; the standard distributions differ between libraries.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// 0 .. n - 1. The bias of the remainder is below n / 2^64.
  std::size_t below(std::size_t n) { return engine_() % n; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(engine_() & 0xFFU); }
  /// Random bytes of which one in three is 0, to exercise COBS.
  std::uint8_t byteOftenZero() { return below(3) == 0 ? std::uint8_t{0} : byte(); }
  Bytes bytes(std::size_t size) {
    Bytes result(size);
    for (auto& each : result) each = byte();
    return result;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace lab::wire
