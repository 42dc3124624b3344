#include "robot/wire/crc16.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/robot/wire/frames.hpp"

namespace lab::wire {
namespace {

std::uint16_t crcOf(const Bytes& bytes) {
  return crc16(bytes.data(), static_cast<std::uint16_t>(bytes.size()));
}

TEST(Crc16, HasTheCheckValueOfX25) {
  EXPECT_EQ(crcOf({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0x906E);
  EXPECT_EQ(crcOf({}), 0x0000);
}

TEST(Crc16, IsTheBitwiseCrcOfAnyBytes) {
  Draws draws(1);
  for (std::size_t size = 0; size <= 64; ++size) {
    for (int i = 0; i < 50; ++i) {
      const Bytes bytes = draws.bytes(size);
      ASSERT_EQ(crcOf(bytes), crcByTheBook(bytes));
    }
  }
}

TEST(Crc16, HasTheKnownResidueAfterItsOwnValue) {
  const Bytes bytes{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  // The state is 0xF0B8, its complement 0x0F47.
  EXPECT_EQ(crcOf(bytes + Bytes{0x6E, 0x90}), 0x0F47);
}

TEST(Crc16, DetectsAnAppendedZero) {
  const Bytes bytes{1, 2, 3};
  const std::uint16_t crc = crcOf(bytes);
  const Bytes whole =
      bytes + Bytes{static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8)};
  EXPECT_NE(crcOf(whole), crcOf(whole + Bytes{0}));
}

}  // namespace
}  // namespace lab::wire
