/// Interface for waiting on file descriptors. A service gets it from outside, like its bus and its
/// clock.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>

namespace lab {

class DescriptorWatcher {
 public:
  /// Destroying it ends the watch. The DescriptorWatcher must outlive it.
  class Watch {
   public:
    Watch() = default;
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    virtual ~Watch() = default;
  };

  DescriptorWatcher() = default;
  DescriptorWatcher(const DescriptorWatcher&) = delete;
  DescriptorWatcher& operator=(const DescriptorWatcher&) = delete;
  virtual ~DescriptorWatcher() = default;

  /// Calls `callback` whenever `descriptor` is readable or hung up, until the returned object is
  /// destroyed, which must be before the descriptor is closed. The callback may destroy it. The
  /// caller keeps ownership of the descriptor.
  [[nodiscard]] virtual std::unique_ptr<Watch> watch(int descriptor,
                                                     std::function<void()> callback) = 0;
};

/// A watcher for virtual time, whose watch() throws std::logic_error.
[[nodiscard]] DescriptorWatcher& noDescriptorWatcher();

}  // namespace lab
