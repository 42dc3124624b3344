/// File descriptors that wake a service, given to it from outside like its bus and its clock.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>

namespace lab {

class DescriptorWatcher {
 public:
  /// Ends what watch() began, when it is destroyed. The DescriptorWatcher must outlive it.
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

  /// Calls `callback` whenever `descriptor` has something to read or is hung up, until the returned
  /// object is destroyed, which must be before the descriptor is closed. The callback may destroy
  /// it. The descriptor stays its owner's.
  [[nodiscard]] virtual std::unique_ptr<Watch> watch(int descriptor,
                                                     std::function<void()> callback) = 0;
};

/// Where nothing can be watched: in virtual time.
/// @throws std::logic_error from watch().
[[nodiscard]] DescriptorWatcher& noDescriptorWatcher();

}  // namespace lab
