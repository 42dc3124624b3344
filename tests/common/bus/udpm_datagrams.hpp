/// Datagrams as LCM sends them, and bad ones.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace lab::udpm_test {

using Datagram = std::vector<std::uint8_t>;

inline void append32(Datagram& datagram, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    datagram.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

inline void append(Datagram& datagram, std::string_view text) {
  datagram.insert(datagram.end(), text.begin(), text.end());
}

/// A whole message (LC02).
inline Datagram whole(std::string_view channel, std::string_view data) {
  Datagram datagram;
  append(datagram, "LC02");
  append32(datagram, 0);
  append(datagram, channel);
  datagram.push_back(0);
  append(datagram, data);
  return datagram;
}

/// The header of a fragment (LC03).
struct FragmentHeader {
  std::uint32_t sequence = 1;
  std::uint32_t message_size = 0;
  std::uint32_t offset = 0;
  std::uint32_t number = 0;
  std::uint32_t fragments = 1;
};

/// @param content data; of fragment 0, the channel and a zero byte before it
inline Datagram fragment(const FragmentHeader& header, std::string_view content) {
  Datagram datagram;
  append(datagram, "LC03");
  append32(datagram, header.sequence);
  append32(datagram, header.message_size);
  append32(datagram, header.offset);
  append32(datagram, header.number << 16 | header.fragments);
  append(datagram, content);
  return datagram;
}

}  // namespace lab::udpm_test
