/// Runs a live loop in a test until a condition is true.
#pragma once

#include <cstdint>
#include <functional>

#include "common/loop/asio_loop.hpp"

namespace lab {

/// Runs `loop` and checks `condition` every millisecond, at most for a minute.
/// @return the last value of `condition`
inline bool loopUntil(AsioLoop& loop, const std::function<bool()>& condition) {
  const std::int64_t deadline = loop.now() + 60'000'000;
  std::function<void()> check = [&] {
    if (condition() || loop.now() > deadline) {
      loop.stop();
    } else {
      loop.at(loop.now() + 1000, check);
    }
  };
  check();
  if (!condition()) loop.run();
  return condition();
}

}  // namespace lab
