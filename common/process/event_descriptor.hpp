/// A file descriptor by which one thread wakes another.
#pragma once

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Readable from signal() until clear(), for loops and poll(). Both may be called from any thread.
class EventDescriptor {
 public:
  /// @throws std::system_error if no file descriptor is left
  EventDescriptor();

  [[nodiscard]] int get() const { return descriptor_.get(); }

  void signal() const;

  /// Clear before reading what was signalled, so that later arrivals signal again.
  void clear() const;

 private:
  FileDescriptor descriptor_;
};

}  // namespace lab
