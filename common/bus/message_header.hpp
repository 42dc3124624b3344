/// What every message of the lab starts with.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "common/bus/bus.hpp"

namespace lab {

/// Every type that travels on a channel begins with utime, sender, instance, seq: a listener that
/// does not know the type can still say who sent it and what was lost.
struct MessageHeader {
  std::int64_t fingerprint = 0;  ///< LCM's hash of the type
  std::int64_t utime = 0;        ///< [us since 1970]
  std::string_view sender;       ///< lives as long as the bytes
  std::int64_t instance = 0;
  std::int64_t seq = 0;
};

/// @return nothing when the bytes are too short or the sender's length makes no sense.
[[nodiscard]] std::optional<MessageHeader> peekHeader(Bytes data);

}  // namespace lab
