/// The checks that receivers make of a message, for code that learns its type from its bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab::schema {

/// What receivers use of one message.
struct CheckedEncoding {
  bool decoded = false;      ///< it is a message of a type that is sent on a channel
  bool usable = false;       ///< decoded, and nothing but `removed` is impossible
  std::string problem{};     ///< the first one, with what was found and expected; empty: none
  std::int64_t removed = 0;  ///< robots and detections with impossible numbers
  std::vector<std::uint8_t> remaining{};  ///< the message without them, if any were removed
};

/// Decodes and checks a message of a log, of any size, as the report does.
[[nodiscard]] CheckedEncoding checkEncoding(Bytes encoding);

/// Decodes and checks a message of the bus as Node::subscribe() does: also its size
/// (message_sizes.hpp) and the length of its sender's name.
[[nodiscard]] CheckedEncoding checkReceived(Bytes encoding);

}  // namespace lab::schema
