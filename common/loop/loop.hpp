/// Interface for time and timers. A service gets it from outside: a live event loop or virtual
/// time.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <utility>

namespace lab {

class Loop {
 public:
  using Callback = std::function<void()>;

  Loop() = default;
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;
  virtual ~Loop() = default;

  /// Now [us since 1970].
  [[nodiscard]] virtual std::int64_t now() const = 0;

  /// Whether time is simulated. If so, results must not depend on the host or the process.
  [[nodiscard]] virtual bool isVirtual() const = 0;

  /// Calls `callback` once at `utime`, or as soon as possible if that has passed.
  virtual void at(std::int64_t utime, Callback callback) = 0;

  /// Calls `callback` at first_utime + n period_us, n = 0, 1, 2, ..., for the loop's lifetime. A
  /// live loop that falls behind skips the missed calls.
  /// @throws std::invalid_argument if the period is not positive
  virtual void every(std::int64_t period_us, std::int64_t first_utime, Callback callback) = 0;

  /// Calls `callback` after the running callback has returned.
  void soon(Callback callback) { at(now(), std::move(callback)); }

  /// Makes the loop's run() return.
  virtual void stop() = 0;

 protected:
  static void checkPeriod(std::int64_t period_us) {
    if (period_us <= 0) throw std::invalid_argument("the period of a timer must be positive");
  }
};

}  // namespace lab
