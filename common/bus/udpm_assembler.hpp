/// The wire format of LCM's UDP multicast: datagrams become messages. Any bytes are safe.
///
/// LC02 is a whole message: magic, sequence number, channel, 0, data. LC03 is a fragment of one:
/// magic, sequence number, message size, offset, fragment number, number of fragments, and, in
/// fragment 0, the channel and 0; then data. All numbers are big-endian. (LCM, docs/content/
/// udp-multicast-protocol.md.) liblcm 1.3.1 and 1.5.2 add offset and size of a fragment in 32 bits
/// and so can write out of bounds, and read a channel beyond the end of a datagram.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/bus/bus.hpp"
#include "common/bus/refused_datagrams.hpp"

namespace lab {

/// A received message.
struct UdpmMessage {
  std::string channel;
  std::unique_ptr<std::uint8_t[]> data;
  std::size_t size = 0;             ///< [byte] of data
  std::int64_t received_utime = 0;  ///< of the (last) datagram, [us since 1970]
};

/// Not thread-safe.
class UdpmAssembler {
 public:
  static constexpr std::uint32_t kLongestMessage = 16U << 20;  ///< [byte] if in fragments
  /// Limits of what is kept of messages that are not complete. Beyond them the one that has waited
  /// longest is given up. A sender of LCM finishes one message before it begins the next.
  static constexpr std::size_t kMostOpen = 64;
  static constexpr std::size_t kMostOpenOfOneSource = 4;
  static constexpr std::size_t kMostOpenBytes = 32U << 20;
  static constexpr std::size_t kMostGaps = 256;  ///< in one message
  /// A message is given up after this time without a further fragment.
  static constexpr std::int64_t kLongestWait_us = 2'000'000;

  /// @param wants whether somebody subscribes to a channel; messages of others are dropped
  explicit UdpmAssembler(std::function<bool(std::string_view channel)> wants)
      : wants_(std::move(wants)) {}

  /// @param utime time of arrival [us since 1970]
  /// @return a message that this datagram completes
  std::optional<UdpmMessage> take(const DatagramSource& source, Bytes datagram, std::int64_t utime);

  [[nodiscard]] RefusedDatagrams& refused() { return refused_; }
  [[nodiscard]] const RefusedDatagrams& refused() const { return refused_; }

  [[nodiscard]] std::size_t openMessages() const { return open_.size(); }
  [[nodiscard]] std::size_t openBytes() const { return open_bytes_; }

 private:
  struct Fragment {
    std::uint32_t sequence = 0;
    std::uint32_t message_size = 0;
    std::uint32_t offset = 0;
    std::uint16_t number = 0;
    std::uint16_t fragments = 0;
    Bytes data;
    std::string_view channel;  ///< of fragment 0
  };
  /// A message of which fragments are missing.
  struct Open {
    DatagramSource source;
    std::uint32_t sequence = 0;
    std::uint32_t size = 0;
    std::uint16_t fragments = 0;
    bool has_channel = false;
    UdpmMessage message;
    std::map<std::uint32_t, std::uint32_t> pieces;  ///< begin -> end of what is there
  };
  using OpenMessages = std::list<Open>;  ///< the last one has changed last

  std::optional<UdpmMessage> takeWhole(const DatagramSource& source, Bytes datagram,
                                       std::int64_t utime);
  std::optional<UdpmMessage> takeFragment(const DatagramSource& source, const Fragment& fragment,
                                          std::int64_t utime);
  /// @return the fragment, or nothing if it was refused
  std::optional<Fragment> readFragment(const DatagramSource& source, Bytes datagram);
  OpenMessages::iterator openFor(const DatagramSource& source, const Fragment& fragment);
  void makeRoom(const DatagramSource& source, std::size_t bytes);
  void giveUp(OpenMessages::iterator open);
  void remove(OpenMessages::iterator open);
  std::nullopt_t refuse(Refusal reason, const DatagramSource& source);

  std::function<bool(std::string_view)> wants_;
  OpenMessages open_;
  std::size_t open_bytes_ = 0;
  RefusedDatagrams refused_;
};

}  // namespace lab
