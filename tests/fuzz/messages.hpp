/// Messages of the lab in a fuzzer's input. The input leaves out their fingerprints, because a
/// message with a wrong one never gets behind decode().
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "tests/fuzz/input.hpp"

namespace lab::fuzz {

/// The encoding of a message with this fingerprint.
[[nodiscard]] inline std::vector<std::uint8_t> encoding(std::int64_t fingerprint,
                                                        std::span<const std::uint8_t> fields) {
  std::vector<std::uint8_t> bytes;
  for (int shift = 56; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  }
  bytes.insert(bytes.end(), fields.begin(), fields.end());
  return bytes;
}

/// A message from the input, with its size in front; `message` is unchanged if it is none.
template <class Message>
void read(Input& input, Message& message) {
  const auto fields = input.take(input.number<std::uint16_t>());
  static_cast<void>(decode(encoding(Message::getHash(), fields), message));
}

/// A message on a channel, and the time until the next one.
struct TimedMessage {
  std::string_view channel;
  std::vector<std::uint8_t> data;
  std::int64_t wait_us = 0;
};

/// One message: the channel's number in channels::kAll, the time, the size, the fields. The highest
/// bit of the first byte sends the fields as they are, without a fingerprint.
[[nodiscard]] TimedMessage nextMessage(Input& input);

}  // namespace lab::fuzz
