/// What all receivers of a message do with its bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/message_sizes.hpp"
#include "common/bus/message_values.hpp"

namespace lab {

/// A decoded message, without the robots that have impossible numbers.
template <class Message>
struct ReceivedMessage {
  bool decoded = false;
  Message message{};
  /// What was removed, or why the message must not be used: it may be decoded, but has impossible
  /// numbers, or it is too large to be decoded.
  std::optional<ImpossibleNumbers> removed;
};

/// Decodes and checks a message. Receivers in one process share the result (Packet::number).
template <class Message>
[[nodiscard]] std::shared_ptr<const ReceivedMessage<Message>> receive(const Packet& packet) {
  thread_local std::uint64_t number = 0;
  thread_local std::shared_ptr<const ReceivedMessage<Message>> last;
  if (packet.number != 0 && packet.number == number) return last;
  auto received = std::make_shared<ReceivedMessage<Message>>();
  if (auto problem = tooLarge<Message>(packet.data)) {
    received->removed = ImpossibleNumbers{std::move(*problem)};
  } else {
    received->decoded = decode(packet.data, received->message);
    if (received->decoded) received->removed = removeImpossible(received->message);
  }
  if (packet.number != 0) {
    number = packet.number;
    last = received;
  }
  return received;
}

}  // namespace lab
