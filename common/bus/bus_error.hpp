#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace lab {

/// The network cannot carry the lab. The text says what to do about it.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// LCM's limit, kept on every bus. @throws BusError for a longer name.
inline void checkChannelName(std::string_view channel) {
  constexpr std::size_t kLongest = 63;
  if (channel.size() <= kLongest) return;
  throw BusError("channel name '" + std::string(channel) + "' is longer than 63 characters");
}

}  // namespace lab
