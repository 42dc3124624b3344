/// The live event loop, on standalone Asio.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "common/loop/descriptor_watcher.hpp"
#include "common/loop/loop.hpp"

namespace asio {
class io_context;
}

namespace lab {

/// now() is the wall clock at construction plus the steady time since then, so a step of the wall
/// clock during a run changes neither timers nor time stamps.
class AsioLoop final : public Loop, public DescriptorWatcher {
 public:
  /// @param clock_offset_us the clockOffset() of another process on this machine, for its time;
  ///   nothing: the wall clock now
  explicit AsioLoop(std::optional<std::int64_t> clock_offset_us = std::nullopt);
  ~AsioLoop() override;

  [[nodiscard]] std::int64_t now() const override;

  /// now() minus the steady clock of this machine [us].
  [[nodiscard]] std::int64_t clockOffset() const;
  [[nodiscard]] bool isVirtual() const override { return false; }
  void at(std::int64_t utime, Callback callback) override;
  void every(std::int64_t period_us, std::int64_t first_utime, Callback callback) override;
  void stop() override;

  /// Calls `callback` whenever `descriptor` is readable or hung up, for the loop's lifetime. The
  /// caller keeps ownership of the descriptor.
  void onReadable(int descriptor, Callback callback);

  [[nodiscard]] std::unique_ptr<Watch> watch(int descriptor, Callback callback) override;

  /// Calls `callback(signal)` instead of the default action.
  void onSignals(std::initializer_list<int> signals, std::function<void(int)> callback);

  /// Runs until stop(). An exception of a callback ends it and is passed on to the caller.
  void run();

  /// Handles what is due now, without waiting.
  void poll();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab
