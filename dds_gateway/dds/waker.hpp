/// From Cyclone's threads to our loop.
#pragma once

namespace lab::dds {

/// A file descriptor that is readable while something has arrived: for DescriptorWatcher::watch().
/// The loop's thread does all the work; Cyclone's threads only ring.
class Waker {
 public:
  /// @throws std::system_error without file descriptors.
  Waker();
  ~Waker();
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;

  [[nodiscard]] int fileDescriptor() const { return descriptor_; }

  /// From any thread.
  void ring() const;

  /// Before everything that may have arrived is taken.
  void quiet() const;

 private:
  int descriptor_;
};

}  // namespace lab::dds
