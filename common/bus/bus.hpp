/// The bus: bytes on named channels. Services see only this, so that the same service runs on the
/// live network, in one process in virtual time, and from a log.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

using Bytes = std::span<const std::uint8_t>;

/// One message as it arrived. The views live only during the handler's call.
struct Packet {
  std::string_view channel;
  Bytes data;
  std::int64_t received_utime = 0;  ///< [us since 1970]
};

using PacketHandler = std::function<void(const Packet&)>;

class Bus {
 public:
  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  /// Sends `data` on `channel` (at most 63 characters).
  /// @throws BusError when the transport refuses it.
  virtual void publish(std::string_view channel, Bytes data) = 0;

  /// Calls `handler` for every message on exactly this channel. A subscription lasts as long as the
  /// bus: subscribe at start, before traffic flows.
  virtual void subscribe(std::string_view channel, PacketHandler handler) = 0;

  /// Calls `handler` for every message of the lab on any channel.
  virtual void subscribeAll(PacketHandler handler) = 0;
};

/// The message as bytes. LCM's encoder trusts the count fields: keep them equal to the sizes.
/// @throws std::logic_error when the type cannot be encoded.
template <class Message>
std::vector<std::uint8_t> encode(const Message& message);

/// Decodes into a fresh message (LCM leaves old vector contents in a reused one), and accepts it
/// only when all bytes were used (LCM ignores a tail). Counts and lengths are checked before LCM's
/// generated decoder trusts them (lcmtypes/encoding_checker.hpp). Never throws: a failed allocation
/// is a decode error like any other.
/// @return whether `data` is a Message.
template <class Message>
[[nodiscard]] bool decode(Bytes data, Message& message) noexcept;

}  // namespace lab

#include "common/bus/codec.hpp"
