#include "common/bus/message_header.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace lab {
namespace {

/// LCM is big endian on the wire.
std::int64_t bigEndian(Bytes data) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : data) value = (value << 8U) | byte;
  return static_cast<std::int64_t>(value);
}

}  // namespace

std::optional<MessageHeader> peekHeader(Bytes data) {
  constexpr std::size_t kSenderLength = 16;  // after fingerprint and utime
  constexpr std::size_t kSender = 20;
  if (data.size() < kSender) return std::nullopt;
  const std::int64_t length = bigEndian(data.subspan(kSenderLength, 4));  // includes the final 0
  if (length < 1) return std::nullopt;
  const auto size = static_cast<std::size_t>(length);
  if (size > kLongestSender + 1) return std::nullopt;
  if (data.size() < kSender + size + 16) return std::nullopt;
  const Bytes sender = data.subspan(kSender, size);
  if (std::ranges::find(sender, 0) != sender.end() - 1) return std::nullopt;
  MessageHeader header;
  header.fingerprint = bigEndian(data.first(8));
  header.utime = bigEndian(data.subspan(8, 8));
  header.sender = {reinterpret_cast<const char*>(data.data()) + kSender, size - 1};
  header.instance = bigEndian(data.subspan(kSender + size, 8));
  header.seq = bigEndian(data.subspan(kSender + size + 8, 8));
  return header;
}

}  // namespace lab
