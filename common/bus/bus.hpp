/// The message bus: bytes on named channels. Services use only this interface, so the same service
/// runs on the live network, in one process in virtual time, and from a log.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

using Bytes = std::span<const std::uint8_t>;

/// One received message. The views are valid only during the handler's call.
struct Packet {
  std::string_view channel;
  Bytes data;
  std::int64_t received_utime = 0;  ///< [us since 1970]
  /// The same for all receivers of a message in this process, which can share what they decode; 0:
  /// they cannot.
  std::uint64_t number = 0;
};

using PacketHandler = std::function<void(const Packet&)>;

class Bus {
 public:
  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  /// Sends `data` on `channel` (at most 63 characters).
  /// @throws BusError if the transport cannot send it
  virtual void publish(std::string_view channel, Bytes data) = 0;

  /// Calls `handler` for every message on exactly this channel. A subscription lasts as long as the
  /// bus: subscribe at start-up, before messages arrive.
  virtual void subscribe(std::string_view channel, PacketHandler handler) = 0;

  /// Calls `handler` for every message on any channel, except LCM's own probe.
  virtual void subscribeAll(PacketHandler handler) = 0;

  /// For how long the oldest message that no handler has got yet has been waiting [us]; 0: none
  /// waits.
  [[nodiscard]] virtual std::int64_t backlog() const { return 0; }
};

/// Encodes a message. LCM's encoder trusts the count fields (num_...): keep them equal to the
/// sizes.
/// @throws std::logic_error if the message cannot be encoded
template <class Message>
std::vector<std::uint8_t> encode(const Message& message);

/// Decodes into a new object, because LCM leaves old vector elements in a reused one. Accepts the
/// message only if all bytes were used; LCM itself ignores surplus bytes. Never throws: if a
/// corrupt array length makes LCM's generated decoder throw, that counts as a decoding error.
/// @return whether `data` is a Message; if not, `message` is unchanged
template <class Message>
[[nodiscard]] bool decode(Bytes data, Message& message) noexcept;

}  // namespace lab

#include "common/bus/codec.hpp"
