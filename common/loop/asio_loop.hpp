/// The live event loop, on standalone Asio.
#pragma once

#include <functional>
#include <memory>

#include "common/loop/descriptor_watcher.hpp"
#include "common/loop/loop.hpp"

namespace asio {
class io_context;
}

namespace lab {

/// Steady clocks pace, the wall clock stamps: now() is the wall clock read once at construction
/// plus the steady time since, so that a step of the wall clock during a run moves nothing.
class AsioLoop final : public Loop, public DescriptorWatcher {
 public:
  AsioLoop();
  ~AsioLoop() override;

  [[nodiscard]] std::int64_t now() const override;
  [[nodiscard]] bool isVirtual() const override { return false; }
  void at(std::int64_t utime, Callback callback) override;
  void every(std::int64_t period_us, std::int64_t first_utime, Callback callback) override;
  void stop() override;

  /// Calls `callback` whenever `descriptor` has something to read or is hung up, for the loop's
  /// life. The descriptor stays its owner's.
  void onReadable(int descriptor, Callback callback);

  [[nodiscard]] std::unique_ptr<Watch> watch(int descriptor, Callback callback) override;

  /// Calls `callback(signal)` instead of the default action.
  void onSignals(std::initializer_list<int> signals, std::function<void(int)> callback);

  /// Runs until stop(). An exception of a callback ends it and comes out here.
  void run();

  /// Does what is due now, without waiting: for those who wait in another way.
  void poll();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab
