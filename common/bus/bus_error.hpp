/// The error of the message bus.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lab {

/// The bus cannot be opened or used. what() says how to repair it.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// LCM_MAX_CHANNEL_NAME_LENGTH; every bus enforces this limit.
inline constexpr std::size_t kLongestChannelName = 63;

/// @throws BusError for a longer name
inline void checkChannelName(std::string_view channel) {
  if (channel.size() <= kLongestChannelName) return;
  throw BusError("channel name '" + std::string(channel) + "' is longer than 63 characters");
}

}  // namespace lab
