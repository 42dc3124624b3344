/// File descriptors: ownership, and closing what a child does not need.
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

enum class Close { kNow, kAtExec };

/// Closes the descriptors from `first` on. System calls only, for use after fork().
void closeFrom(int first, Close when);

/// The same as Linux before 5.11 can do it, which has no close_range() for both.
void closeOneByOneFrom(int first, Close when);

}  // namespace lab
