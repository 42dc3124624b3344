// The share of damaged frames that are accepted, compared with the expectation for a 16-bit CRC.
// docs/protocol.md quotes the figures that these tests print.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/robot/wire/tally.hpp"

namespace lab::wire {
namespace {

void flip(Bytes& bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
}

TEST(LineErrors, InOneBitAreDetected) {
  Draws draws(11);
  Decoder decoder;
  Tally tally;
  for (std::uint64_t round = 0; round < triesOr(1000000) / 5000; ++round) {
    for (const Frame& frame : drawnFrames(draws)) {
      Bytes bytes = encoded(frame);
      for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        flip(bytes, bit);
        spoil(decoder, frame, bytes, tally);
        flip(bytes, bit);
      }
    }
  }
  tally.print("one bit");
  // Not zero, because one wrong bit in a COBS code moves zeros and so changes many bits.
  EXPECT_LE(tally.wrong, tally.limit());
  EXPECT_GT(tally.checked, tally.tried / 2);
}

TEST(LineErrors, InTwoBitsAreDetectedExceptTheShareOfTheCrc) {
  Draws draws(12);
  Decoder decoder;
  Tally tally;
  for (std::uint64_t round = 0; 250000 * round < triesOr(1000000); ++round) {
    for (const Frame& frame : drawnFrames(draws)) {
      Bytes bytes = encoded(frame);
      for (std::size_t first = 0; first < 8 * bytes.size(); ++first) {
        flip(bytes, first);
        for (std::size_t second = 0; second < first; ++second) {
          flip(bytes, second);
          spoil(decoder, frame, bytes, tally);
          flip(bytes, second);
        }
        flip(bytes, first);
      }
    }
  }
  tally.print("two bits");
  EXPECT_LE(tally.wrong, tally.limit());
  EXPECT_GT(tally.checked, tally.tried / 2);
}

TEST(LineErrors, InUpToTwoBitsAreAlwaysDetectedOutsideTheStuffing) {
  // Before COBS, the Hamming distance of the CRC guarantees that up to three wrong bits are
  // detected.
  Draws draws(13);
  Decoder decoder;
  Tally tally;
  for (const Frame& frame : drawnFrames(draws)) {
    Bytes raw = Bytes{kProtocolVersion, frame.type, frame.seq, frame.size} +
                Bytes(frame.payload, frame.payload + frame.size);
    const std::uint16_t crc = crcByTheBook(raw);
    raw = raw + Bytes{static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8)};
    for (std::size_t first = 0; first < 8 * raw.size(); ++first) {
      flip(raw, first);
      spoil(decoder, frame, stuffed(raw), tally);
      for (std::size_t second = 0; second < first; ++second) {
        flip(raw, second);
        spoil(decoder, frame, stuffed(raw), tally);
        flip(raw, second);
      }
      flip(raw, first);
    }
  }
  tally.print("one and two bits before stuffing");
  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_EQ(tally.checked, tally.tried);
}

TEST(LineErrors, OfAnyKindBehindAValidHeaderPassOnceIn65536) {
  // The worst case: everything behind the header is random. This measures the share that the CRC
  // cannot detect, and shows that the bound of the other tests is neither too high nor too low.
  Draws draws(14);
  Decoder decoder;
  Tally tally;
  for (std::uint64_t i = 0; i < 4 * triesOr(1000000); ++i) {
    const std::size_t size = draws.below(12);
    const Bytes raw =
        Bytes{kProtocolVersion, 0x95, 3, static_cast<std::uint8_t>(size)} + draws.bytes(size + 2);
    spoil(decoder, Frame{}, stuffed(raw), tally);
  }
  tally.print("right header, the rest drawn");
  EXPECT_EQ(tally.checked, tally.tried);
  const double expected = static_cast<double>(tally.checked) / kCrcValues;
  EXPECT_LE(tally.wrong, tally.limit());
  EXPECT_GE(static_cast<double>(tally.wrong), expected - 6 * std::sqrt(expected));
}

TEST(LineErrors, RandomBytesAreNotAcceptedAsFrames) {
  // Version and length are 16 more bits that would have to be correct by chance.
  Draws draws(15);
  Decoder decoder;
  Tally tally;
  const Frame none;
  for (std::uint64_t i = 0; i < 4 * triesOr(1000000); ++i) {
    spoil(decoder, none, draws.bytes(6 + draws.below(40)), tally);
  }
  tally.print("random bytes");
  EXPECT_LE(tally.wrong, tally.limit(32));
  EXPECT_GT(tally.checked, tally.tried / 1000) << "random bytes that reach the CRC";
}

/// 1 to 4 typical changes by lines and buffers.
Bytes mutated(Bytes bytes, Draws& draws) {
  const std::size_t changes = 1 + draws.below(4);
  for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
    const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(draws.below(bytes.size()));
    switch (draws.below(6)) {
      case 0:
        *at = draws.byte();
        break;
      case 1:
        *at = static_cast<std::uint8_t>(*at ^ (1U << draws.below(8)));
        break;
      case 2:
        bytes.erase(at);
        break;
      case 3:
        bytes.insert(at, draws.byteOftenZero());
        break;
      case 4:
        std::swap(*at, bytes[draws.below(bytes.size())]);
        break;
      default:
        bytes.insert(at, *at);
        break;
    }
  }
  return bytes;
}

TEST(LineErrors, MutatedFramesAreDetectedExceptTheShareOfTheCrc) {
  Draws draws(16);
  Decoder decoder;
  Tally tally;
  std::vector<Frame> frames;
  for (std::uint64_t i = 0; i < 2 * triesOr(1000000); ++i) {
    if (i % 1000 == 0) frames = drawnFrames(draws);
    const Frame& frame = frames[i % frames.size()];
    spoil(decoder, frame, mutated(encoded(frame), draws), tally);
  }
  tally.print("mutated frames");
  EXPECT_LE(tally.wrong, tally.limit());
  EXPECT_GT(tally.checked, tally.tried / 5);
}

}  // namespace
}  // namespace lab::wire
