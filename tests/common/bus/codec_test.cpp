// Decoding of messages and headers with arbitrary bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/message_header.hpp"

namespace lab::codec_test {
namespace {

robot_status_t statusOfTwo() {
  robot_status_t status{};
  status.utime = 5;
  status.sender = "sim_svc";
  status.instance = 7;
  status.seq = 9;
  status.robots.resize(2);
  status.num_robots = 2;
  return status;
}

constexpr std::size_t kSenderLength = 16;
constexpr std::size_t kCount = 20 + sizeof "sim_svc" + 16;  // num_robots on the wire

/// Replaces the bytes at `offset` by a big-endian number.
std::vector<std::uint8_t> with(std::vector<std::uint8_t> bytes, std::size_t offset,
                               std::int32_t number) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[offset + i] =
        static_cast<std::uint8_t>(static_cast<std::uint32_t>(number) >> (24 - 8 * i));
  }
  return bytes;
}

TEST(Codec, DecodesWhatItEncoded) {
  robot_status_t heard{};
  ASSERT_TRUE(decode(encode(statusOfTwo()), heard));
  EXPECT_EQ(heard.sender, "sim_svc");
  EXPECT_EQ(heard.seq, 9);
  EXPECT_EQ(heard.robots.size(), 2U);
}

TEST(Codec, RefusesArbitraryBytes) {
  robot_status_t heard{};
  std::vector<std::uint8_t> bytes(300);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  EXPECT_FALSE(decode(bytes, heard));
  EXPECT_FALSE(decode({}, heard));
}

TEST(Codec, RefusesAnotherType) {
  robot_stop_t heard{};
  EXPECT_FALSE(decode(encode(statusOfTwo()), heard));
}

TEST(Codec, RefusesEveryTruncation) {
  const std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    robot_status_t heard{};
    EXPECT_FALSE(decode(Bytes(bytes).first(size), heard)) << size << " bytes";
  }
}

TEST(Codec, RefusesSurplusBytes) {  // LCM itself ignores them
  std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  bytes.push_back(0);
  robot_status_t heard{};
  EXPECT_FALSE(decode(bytes, heard));
}

TEST(Codec, RefusesImpossibleLengthsWithoutThrowing) {
  const std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  for (const std::int32_t length : {-1, -1'000'000, 1, 3}) {
    robot_status_t heard{};
    EXPECT_FALSE(decode(with(bytes, kCount, length), heard)) << length << " robots";
  }
  for (const std::int32_t length : {-1, 0, 1'000'000}) {
    robot_status_t heard{};
    EXPECT_FALSE(decode(with(bytes, kSenderLength, length), heard)) << length << " letters";
  }
}

// A list of 8-byte numbers: 8 times this count is 0 in 32 bits, which once made decode() request 4
// GB.
TEST(Codec, RefusesCountsWhoseBytesOverflow) {
  light_status_t status{};
  status.tracked_frames = {1, 2, 3};
  status.num_tracked_frames = 3;
  const std::vector<std::uint8_t> bytes = encode(status);
  const std::vector<std::uint8_t> count{0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1};
  const auto at = std::search(bytes.begin(), bytes.end(), count.begin(), count.end());
  ASSERT_NE(at, bytes.end());
  for (const std::int32_t wrong : {0x20000000, 0x20000003, 0x7fffffff}) {
    light_status_t heard{};
    const auto place = static_cast<std::size_t>(at - bytes.begin());
    EXPECT_FALSE(decode(with(bytes, place, wrong), heard)) << wrong;
  }
}

TEST(Codec, RefusesTextsThatCannotBeEncodedAgain) {
  std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  bytes[kSenderLength + 4 + 3] = 0;  // "sim" and more
  robot_status_t heard{};
  EXPECT_FALSE(decode(bytes, heard));
  const std::int32_t least = std::numeric_limits<std::int32_t>::min();
  EXPECT_FALSE(decode(with(encode(statusOfTwo()), kSenderLength, least), heard));
}

TEST(Codec, LeavesTheMessageUnchangedWhenItRefuses) {
  robot_status_t heard = statusOfTwo();
  EXPECT_FALSE(decode(with(encode(heard), kCount, -1), heard));
  EXPECT_EQ(heard.robots.size(), 2U);
}

TEST(Codec, ClearsAReusedMessage) {  // LCM keeps the old elements of an array
  tracked_frame_t heard{};
  heard.robots.resize(3);
  heard.num_robots = 3;
  ASSERT_TRUE(decode(encode(tracked_frame_t{}), heard));
  EXPECT_TRUE(heard.robots.empty());
}

TEST(MessageHeader, IsReadWithoutKnowingTheType) {
  const std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  const std::optional<MessageHeader> header = peekHeader(bytes);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->fingerprint, robot_status_t::getHash());
  EXPECT_EQ(header->utime, 5);
  EXPECT_EQ(header->sender, "sim_svc");
  EXPECT_EQ(header->instance, 7);
  EXPECT_EQ(header->seq, 9);
}

TEST(MessageHeader, IsNotReadBeyondTheBytes) {
  const std::vector<std::uint8_t> bytes = encode(statusOfTwo());
  for (std::size_t size = 0; size < kCount; ++size) {
    EXPECT_FALSE(peekHeader(Bytes(bytes).first(size))) << size << " bytes";
  }
  EXPECT_TRUE(peekHeader(Bytes(bytes).first(kCount)));
}

TEST(MessageHeader, IsNotReadWithAnImpossibleSenderLength) {
  for (const std::int32_t length : {-1, 0, 65, 1'000'000}) {
    EXPECT_FALSE(peekHeader(with(encode(statusOfTwo()), kSenderLength, length))) << length;
  }
}

TEST(PeekLongSender, FindsNoOtherReasonThanTheLength) {
  robot_status_t status{};
  status.sender = std::string(63, 'x');
  EXPECT_FALSE(peekLongSender(encode(status)));
  status.sender += "\u00B0";  // two bytes
  const std::vector<std::uint8_t> bytes = encode(status);
  ASSERT_TRUE(peekLongSender(bytes));
  EXPECT_EQ(peekLongSender(bytes)->begin, std::string(63, 'x'));
  EXPECT_FALSE(peekLongSender(Bytes(bytes).first(80)));
  EXPECT_FALSE(peekLongSender(with(bytes, kSenderLength, 1'000'000)));
  EXPECT_FALSE(peekLongSender(with(bytes, kSenderLength, 65)));
}

TEST(PeekHeader, RefusesASenderWithAZeroInside) {
  robot_status_t status{};
  status.sender = "sim_svc";
  std::vector<std::uint8_t> bytes = encode(status);
  ASSERT_TRUE(peekHeader(bytes));
  bytes[22] = 0;  // the third letter
  EXPECT_FALSE(peekHeader(bytes));
}

}  // namespace
}  // namespace lab::codec_test
