/// Counts of datagrams that the bus received and did not turn into messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <lab/stream_count_t.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// Source of a datagram, in host byte order.
struct DatagramSource {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
  auto operator<=>(const DatagramSource&) const = default;
};

/// As "10.0.0.5:7667".
[[nodiscard]] std::string sourceText(const DatagramSource& source);

/// Why a datagram became no message.
enum class Refusal : std::uint8_t {
  kStranger,       ///< its source is not this machine, and the bus is not open to others
  kUnicast,        ///< sent to an address of this machine instead of the group (UnicastSink)
  kNotLcm,         ///< no header of LCM
  kBadChannel,     ///< a channel name that does not end, or is longer than LCM allows
  kBadFragment,    ///< a fragment outside of its message, or one that overlaps another
  kTooLong,        ///< a fragment of a message longer than kLongestMessage
  kIncomplete,     ///< a message (not a datagram) whose other fragments did not come
  kQueueFull,      ///< a message for which this process had no more room
  kReceiveBuffer,  ///< lost in the kernel, because the socket's receive buffer was full
};
inline constexpr std::size_t kRefusals = 9;

/// The reason in words, as "source is not this machine".
[[nodiscard]] std::string_view refusalText(Refusal reason);

class RefusedDatagrams {
 public:
  struct Count {
    std::int64_t datagrams = 0;
    DatagramSource last;  ///< source of the last one
  };

  void count(Refusal reason, const DatagramSource& source, std::int64_t datagrams = 1);

  void add(const RefusedDatagrams& other);

  [[nodiscard]] const Count& of(Refusal reason) const {
    return counts_[static_cast<std::size_t>(reason)];
  }

  /// One line per reason that has grown since `before`.
  [[nodiscard]] std::vector<std::string> linesSince(const RefusedDatagrams& before) const;

  /// Rows for SERVICE_STATUS, one per reason that occurred.
  [[nodiscard]] std::vector<stream_count_t> rows() const;

 private:
  std::array<Count, kRefusals> counts_{};
};

}  // namespace lab
