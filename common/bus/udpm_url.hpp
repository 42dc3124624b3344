/// LCM's URLs of UDP multicast: udpm://GROUP:PORT?ttl=N&recv_buf_size=N
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lab {

struct UdpmUrl {
  std::uint32_t group = 0;  ///< multicast address in host byte order
  std::uint16_t port = 0;
  std::uint8_t ttl = 0;
  int receive_buffer = 0;  ///< [byte] for SO_RCVBUF; 0: the system's default
};

/// The provider of a URL of LCM: "udpm", "memq", "file"; empty if it has none.
[[nodiscard]] std::string_view providerOf(std::string_view url);

/// Reads a URL as liblcm 1.3.1 does (lcm_parse_url() and new_argument() of lcm_udpm.c), so that
/// both ends of a bus use the same group: an empty network is LCM's default, numbers may be
/// hexadecimal, of a number only the leading digits count, a ttl is taken modulo 256.
/// @return nothing if it is not udpm://, or group or port are bad
[[nodiscard]] std::optional<UdpmUrl> parseUdpmUrl(std::string_view url);

}  // namespace lab
