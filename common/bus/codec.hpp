/// Encoding and decoding of the generated message types; bus.hpp documents the functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "lcmtypes/encoding_checker.hpp"

namespace lab {

template <class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  const int size = message.getEncodedSize();
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  if (message.encode(bytes.data(), 0, size) != size) {
    throw std::logic_error(std::string("cannot encode ") + Message::getTypeName());
  }
  return bytes;
}

template <class Message>
bool decode(Bytes data, Message& message) noexcept {
  static_assert(CheckedMessage<Message>, "add_lcm_types() makes the check of a message's encoding");
  if (!std::in_range<int>(data.size())) return false;
  const int size = static_cast<int>(data.size());
  EncodingChecker packet(data);
  packet.numbers(sizeof(std::int64_t), 1);  // the fingerprint
  checkFields(packet, &message);
  if (!packet.complete()) return false;
  try {
    Message fresh{};
    if (fresh.decode(data.data(), 0, size) != size) return false;
    message = std::move(fresh);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace lab
