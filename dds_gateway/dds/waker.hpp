/// Wakes the loop from Cyclone's threads.
#pragma once

namespace lab::dds {

/// A file descriptor, for DescriptorWatcher::watch(), that is readable after ring(). All work is
/// done on the loop's thread; Cyclone's threads only call ring().
class Waker {
 public:
  /// @throws std::system_error if there is no free file descriptor
  Waker();
  ~Waker();
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;

  [[nodiscard]] int fileDescriptor() const { return descriptor_; }

  /// Signals the loop. May be called from any thread.
  void ring() const;

  /// Clears the signal. Call it before reading, so that later arrivals signal again.
  void quiet() const;

 private:
  int descriptor_;
};

}  // namespace lab::dds
