/// The common header of all messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/bus/bus.hpp"

namespace lab {

/// Of the name of a sender [bytes].
inline constexpr std::size_t kLongestSender = 63;

/// Every type that is sent on a channel begins with utime, sender, instance, seq. A receiver that
/// does not know the type can still tell who sent it and count lost messages.
struct MessageHeader {
  std::int64_t fingerprint = 0;  ///< LCM's hash of the type
  std::int64_t utime = 0;        ///< [us since 1970]
  std::string_view sender;       ///< valid as long as the bytes
  std::int64_t instance = 0;
  std::int64_t seq = 0;
};

/// @return nothing if the bytes are too short, or if the sender's length is impossible or not that
/// of a text that ends at its first zero
[[nodiscard]] std::optional<MessageHeader> peekHeader(Bytes data);

/// A sender whose name is longer than kLongestSender.
struct LongSender {
  std::string_view begin;  ///< of the name, whole characters; valid as long as the bytes
  std::string problem;     ///< what was found and what was expected
};

/// The sender of a message that has no header because of the length of this name alone.
[[nodiscard]] std::optional<LongSender> peekLongSender(Bytes data);

}  // namespace lab
