#include "common/bus/udpm_url.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <cstdlib>
#include <string>

namespace lab {
namespace {

constexpr std::string_view kSeparator = "://";
constexpr std::string_view kDefaultNetwork = "239.255.76.67:7667";

/// The part before the first `separator`, which is removed from `text` together with that part.
std::string_view cutAt(std::string_view& text, char separator) {
  const std::size_t at = text.find(separator);
  const std::string_view head = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return head;
}

/// As strtol() with base 0. @return nothing if the text begins with no number
std::optional<long> leadingNumber(std::string_view text) {
  const std::string copy(text);
  char* end = nullptr;
  const long value = std::strtol(copy.c_str(), &end, 0);
  if (end == copy.c_str()) return std::nullopt;
  return value;
}

bool readNetwork(std::string_view network, UdpmUrl& url) {
  if (network.empty()) network = kDefaultNetwork;
  const std::string group(cutAt(network, ':'));
  in_addr address{};
  if (inet_aton(group.c_str(), &address) == 0) return false;
  url.group = ntohl(address.s_addr);
  const std::optional<long> port = leadingNumber(network);
  if (!port || *port <= 0 || *port > 65535) return false;
  url.port = static_cast<std::uint16_t>(*port);
  return IN_MULTICAST(url.group);
}

}  // namespace

std::string_view providerOf(std::string_view url) {
  const std::size_t at = url.find(kSeparator);
  return at == std::string_view::npos ? "" : url.substr(0, at);
}

std::optional<UdpmUrl> parseUdpmUrl(std::string_view text) {
  constexpr std::string_view kProvider = "udpm";
  if (providerOf(text) != kProvider) return std::nullopt;
  text.remove_prefix(kProvider.size() + kSeparator.size());
  UdpmUrl url;
  if (!readNetwork(cutAt(text, '?'), url)) return std::nullopt;
  while (!text.empty()) {
    std::string_view value = cutAt(text, '&');
    const std::string_view key = cutAt(value, '=');
    const long number = leadingNumber(value).value_or(0);
    if (key == "ttl") url.ttl = static_cast<std::uint8_t>(number);
    if (key == "recv_buf_size") url.receive_buffer = static_cast<int>(number);
  }
  return url;
}

}  // namespace lab
