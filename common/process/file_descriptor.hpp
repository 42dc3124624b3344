/// Ownership of a file descriptor.
#pragma once

namespace lab {

/// A file descriptor that is closed when its owner is destroyed.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor();

  [[nodiscard]] int get() const { return number_; }

  /// Gives up ownership without closing.
  int release();

 private:
  int number_;
};

}  // namespace lab
