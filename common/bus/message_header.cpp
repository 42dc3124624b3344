#include "common/bus/message_header.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "common/text/utf8.hpp"

namespace lab {
namespace {

constexpr std::size_t kSender = 20;       // after fingerprint, utime and its length
constexpr std::size_t kAfterSender = 16;  // instance and seq

/// LCM is big endian on the wire.
std::int64_t bigEndian(Bytes data) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : data) value = (value << 8U) | byte;
  return static_cast<std::int64_t>(value);
}

/// The name of the sender, of any length.
std::optional<std::string_view> peekSender(Bytes data) {
  constexpr std::size_t kSenderLength = 16;  // after fingerprint and utime
  if (data.size() < kSender) return std::nullopt;
  const std::int64_t length = bigEndian(data.subspan(kSenderLength, 4));  // includes the final 0
  if (length < 1) return std::nullopt;
  const auto size = static_cast<std::size_t>(length);
  if (data.size() < kSender + size + kAfterSender) return std::nullopt;
  const auto* name = reinterpret_cast<const char*>(data.data()) + kSender;
  if (std::memchr(name, 0, size) != name + size - 1) return std::nullopt;
  return std::string_view(name, size - 1);
}

}  // namespace

std::optional<MessageHeader> peekHeader(Bytes data) {
  const std::optional<std::string_view> sender = peekSender(data);
  if (!sender || sender->size() > kLongestSender) return std::nullopt;
  const Bytes after = data.subspan(kSender + sender->size() + 1, kAfterSender);
  MessageHeader header;
  header.fingerprint = bigEndian(data.first(8));
  header.utime = bigEndian(data.subspan(8, 8));
  header.sender = *sender;
  header.instance = bigEndian(after.first(8));
  header.seq = bigEndian(after.last(8));
  return header;
}

std::optional<LongSender> peekLongSender(Bytes data) {
  const std::optional<std::string_view> sender = peekSender(data);
  if (!sender || sender->size() <= kLongestSender) return std::nullopt;
  return LongSender{utf8Prefix(*sender, kLongestSender),
                    "sender: found a name of " + std::to_string(sender->size()) +
                        " bytes, expected at most " + std::to_string(kLongestSender)};
}

}  // namespace lab
