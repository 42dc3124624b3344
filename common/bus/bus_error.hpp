/// The error of the message bus.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace lab {

/// The bus cannot be opened or used. what() says how to repair it.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// LCM limits channel names to 63 characters; every bus enforces this limit.
/// @throws BusError for a longer name
inline void checkChannelName(std::string_view channel) {
  constexpr std::size_t kLongest = 63;
  if (channel.size() <= kLongest) return;
  throw BusError("channel name '" + std::string(channel) + "' is longer than 63 characters");
}

}  // namespace lab
