/// Encoding and decoding of the generated types: see bus.hpp.
#pragma once

#include <limits>
#include <stdexcept>

#include "common/bus.hpp"

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
  if (data.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return false;
  const int size = static_cast<int>(data.size());
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
