#include "robot/wire/frame.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/robot/wire/frames.hpp"

namespace lab::wire {
namespace {

const Frame kSome = frameOf(0x14, 7, {1, 0, 2, 0, 0, 3});

TEST(Encode, WritesAFrameComputedByHand) {
  // Raw 01 02 05 00, its CRC-16/X-25 0x2B65, one zero at offset 3.
  EXPECT_EQ(encoded(frameOf(0x02, 5, {})), (Bytes{0, 4, 2, 2, 5, 3, 0xA8, 0x0E, 0}));
}

TEST(Encode, NeverWritesAZeroBetweenTheFirstAndTheLastByte) {
  Draws draws(2);
  for (std::size_t size = 0; size <= kMaxPayload; ++size) {
    Bytes payload(size);
    for (int i = 0; i < 200; ++i) {
      for (auto& byte : payload) byte = draws.byteOftenZero();
      const Frame frame = frameOf(draws.byteOftenZero(), draws.byteOftenZero(), payload);
      const Bytes bytes = encoded(frame);
      ASSERT_EQ(bytes.size(), size + kFrameOverhead);
      ASSERT_EQ(std::count(bytes.begin(), bytes.end(), 0), 2);
      ASSERT_EQ(bytes, encodedByTheBook(frame));
    }
  }
}

TEST(Decoder, ReadsBackEverySizeAndContent) {
  Draws draws(3);
  Decoder dut;
  std::uint16_t count = 0;
  for (std::size_t size = 0; size <= kMaxPayload; ++size) {
    for (int i = 0; i < 200; ++i) {
      Bytes payload(size);  // all zeros, all ones, then anything
      for (auto& byte : payload) byte = i == 0 ? 0 : i == 1 ? 255 : draws.byteOftenZero();
      const Frame frame = frameOf(draws.byte(), draws.byte(), payload);
      const auto frames = received(dut, encoded(frame));
      ASSERT_EQ(frames.size(), 1U);
      ASSERT_TRUE(frames[0] == frame);
      ++count;
    }
  }
  EXPECT_EQ(dut.counts().frames, count);
  EXPECT_EQ(dut.counts().crc + dut.counts().malformed + dut.counts().version, 0);
}

TEST(Decoder, ReadsAZeroAtEveryPosition) {
  Decoder dut;
  for (std::size_t at = 0; at < kMaxPayload; ++at) {
    Bytes payload(kMaxPayload, 0x55);
    payload[at] = 0;
    const Frame frame = frameOf(1, 1, payload);
    const auto frames = received(dut, encoded(frame));
    ASSERT_EQ(frames.size(), 1U) << at;
    EXPECT_TRUE(frames[0] == frame) << at;
  }
}

TEST(Decoder, GarbageBeforeAFrameDoesNotCostIt) {
  Draws draws(4);
  Decoder dut;
  for (std::size_t garbage = 0; garbage <= 100; ++garbage) {
    const auto frames = received(dut, draws.bytes(garbage) + encoded(kSome));
    ASSERT_EQ(frames.size(), 1U) << garbage << " bytes of garbage";
    EXPECT_TRUE(frames[0] == kSome);
  }
}

TEST(Decoder, LosesOnlyATruncatedFrame) {
  const Bytes whole = encoded(kSome);
  for (std::size_t kept = 1; kept < whole.size() - 1; ++kept) {
    Decoder dut;
    const Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(kept));
    const auto frames = received(dut, half + whole);
    ASSERT_EQ(frames.size(), 1U) << kept << " bytes kept";
    EXPECT_TRUE(frames[0] == kSome);
    // A single 0 does not count as a frame; anything longer is a damaged frame.
    EXPECT_EQ(dut.counts().malformed + dut.counts().crc, kept > 1 ? 1 : 0) << kept;
  }
}

TEST(Decoder, DropsTheSecondPartOfAFrame) {
  const Bytes whole = encoded(kSome);
  for (std::size_t lost = 1; lost < whole.size(); ++lost) {
    Decoder dut;
    const Bytes rest(whole.begin() + static_cast<std::ptrdiff_t>(lost), whole.end());
    // Without its first 0 a frame is still complete.
    EXPECT_EQ(received(dut, rest).size(), lost == 1 ? 1U : 0U) << lost;
    EXPECT_EQ(received(dut, whole).size(), 1U) << lost;
  }
}

TEST(Decoder, ReadsFramesThatShareADelimiter) {
  Decoder dut;
  Bytes bytes = encoded(kSome);
  bytes.pop_back();
  EXPECT_EQ(received(dut, bytes + encoded(kSome)).size(), 2U);
}

TEST(Decoder, LosesTwoFramesWhenBothDelimitersBetweenThemAreGone) {
  Decoder dut;
  Bytes first = encoded(kSome);
  first.pop_back();
  Bytes second = encoded(kSome);
  second.erase(second.begin());
  EXPECT_EQ(received(dut, first + second).size(), 0U);
  EXPECT_EQ(dut.counts().malformed + dut.counts().crc, 1);
  EXPECT_EQ(received(dut, encoded(kSome)).size(), 1U);
}

TEST(Decoder, IgnoresEmptyFrames) {
  Decoder dut;
  EXPECT_TRUE(received(dut, Bytes(100, 0)).empty());
  EXPECT_EQ(dut.counts().malformed, 0);
}

TEST(Decoder, DropsAnEndlessFrameAndReadsTheNextOne) {
  Decoder dut;
  EXPECT_TRUE(received(dut, Bytes(100000, 1)).empty());
  EXPECT_TRUE(received(dut, Bytes(100000, 255)).empty());
  EXPECT_EQ(received(dut, encoded(kSome)).size(), 1U);
  EXPECT_EQ(dut.counts().malformed, 1);
}

TEST(Decoder, AcceptsFortyBytesAndRefusesFortyOne) {
  Decoder dut;
  EXPECT_EQ(received(dut, sealed(Bytes{2, 9, 9, 40} + Bytes(40, 7))).size(), 1U);
  EXPECT_EQ(received(dut, sealed(Bytes{2, 9, 9, 40} + Bytes(40, 0))).size(), 1U);
  EXPECT_EQ(received(dut, sealed(Bytes{2, 9, 9, 41} + Bytes(41, 7))).size(), 0U);
  EXPECT_EQ(received(dut, sealed(Bytes{2, 9, 9, 41} + Bytes(41, 0))).size(), 0U);
  EXPECT_EQ(dut.counts().malformed, 2);
}

TEST(Decoder, RefusesALengthThatDiffersFromThePayload) {
  Decoder dut;
  for (int said = 0; said < 256; ++said) {
    const Bytes raw = Bytes{2, 9, 9, static_cast<std::uint8_t>(said)} + Bytes(5, 7);
    EXPECT_EQ(received(dut, sealed(raw)).size(), said == 5 ? 1U : 0U) << said;
  }
  EXPECT_EQ(dut.counts().malformed, 255);
  EXPECT_EQ(dut.counts().crc, 0);
}

TEST(Decoder, RefusesFramesShorterThanHeaderAndCrc) {
  Decoder dut;
  for (std::size_t size = 0; size < 4; ++size) {
    EXPECT_TRUE(received(dut, sealed(Bytes(size, 1))).empty());
  }
  EXPECT_EQ(dut.counts().malformed, 4);
  EXPECT_EQ(dut.counts().crc, 0);
  // In a frame without length, a byte of the CRC is in its place and may have any value.
  for (unsigned i = 0; i < 65536; ++i) {
    const Bytes raw{2, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i & 0xFFU)};
    ASSERT_TRUE(received(dut, sealed(raw)).empty()) << i;
  }
}

TEST(Decoder, RefusesACobsBlockBeyondTheFrame) {
  Decoder dut;
  Bytes bytes = encoded(frameOf(9, 9, Bytes(5, 7)));  // without zeros: a single COBS block
  ASSERT_EQ(bytes[1], bytes.size() - 2);
  ++bytes[1];
  EXPECT_TRUE(received(dut, bytes).empty());
  EXPECT_EQ(dut.counts().malformed, 1);
  EXPECT_EQ(dut.counts().crc, 0);
}

TEST(Decoder, RefusesAnotherVersionAndReportsIt) {
  Decoder dut;
  EXPECT_EQ(dut.foreignVersion(), 0);
  for (int version = 0; version < 256; ++version) {
    if (version == kProtocolVersion) continue;
    const Bytes raw{static_cast<std::uint8_t>(version), 0x82, 0, 1, 77};
    EXPECT_TRUE(received(dut, sealed(raw)).empty());
    EXPECT_EQ(dut.foreignVersion(), version);
  }
  EXPECT_EQ(dut.counts().version, 255);
  EXPECT_EQ(dut.counts().crc + dut.counts().malformed + dut.counts().frames, 0);
}

TEST(Decoder, CountsAFrameWithAWrongCrc) {
  Bytes bytes = encoded(kSome);
  bytes[bytes.size() - 2] ^= 0x10U;
  Decoder dut;
  EXPECT_TRUE(received(dut, bytes).empty());
  EXPECT_EQ(dut.counts().crc, 1);
  EXPECT_EQ(dut.counts().frames, 0);
}

TEST(Decoder, ResetDropsAPartialFrame) {
  Decoder dut;
  const Bytes whole = encoded(kSome);
  received(dut, Bytes(whole.begin(), whole.begin() + 6));
  dut.reset();
  EXPECT_EQ(received(dut, Bytes(whole.begin() + 1, whole.end())).size(), 1U);
}

TEST(Decoder, DetectsAChangedDelimiter) {
  // Without length and final XOR, this frame followed by a zero would still have a correct CRC.
  Decoder dut;
  Bytes bytes = encoded(kSome);
  bytes.back() = 1;
  EXPECT_TRUE(received(dut, bytes + encoded(kSome)).size() == 1U);
  EXPECT_EQ(dut.counts().crc, 1);
}

}  // namespace
}  // namespace lab::wire
