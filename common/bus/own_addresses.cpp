#include "common/bus/own_addresses.hpp"

#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace lab {

std::vector<std::uint32_t> interfaceAddresses() {
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> list(raw, &freeifaddrs);
  std::vector<std::uint32_t> addresses;
  for (const ifaddrs* entry = list.get(); entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
    addresses.push_back(ntohl(address->sin_addr.s_addr));
  }
  return addresses;
}

OwnAddresses::OwnAddresses(Read read, Clock clock)
    : read_(std::move(read)), clock_(std::move(clock)) {
  this->read();
}

bool OwnAddresses::contains(std::uint32_t address) {
  const auto known = [&] {
    return std::binary_search(addresses_.begin(), addresses_.end(), address);
  };
  if (known()) return true;
  if (clock_() - read_at_ < std::chrono::seconds(1)) return false;
  read();
  return known();
}

void OwnAddresses::read() {
  read_at_ = clock_();
  std::vector<std::uint32_t> addresses = read_();
  if (addresses.empty()) return;
  addresses_ = std::move(addresses);
  std::sort(addresses_.begin(), addresses_.end());
}

}  // namespace lab
