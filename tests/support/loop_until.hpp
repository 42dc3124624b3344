/// Running a live loop in a test until something has happened.
#pragma once

#include <functional>

#include "common/loop/asio_loop.hpp"

namespace lab {

/// @return whether it happened within 20 s: it does, or the test fails.
inline bool loopUntil(AsioLoop& loop, const std::function<bool()>& happened) {
  const std::int64_t patience = loop.now() + 20'000'000;
  std::function<void()> look = [&] {
    if (happened() || loop.now() > patience) {
      loop.stop();
    } else {
      loop.at(loop.now() + 1000, look);
    }
  };
  look();
  if (!happened()) loop.run();
  return happened();
}

}  // namespace lab
