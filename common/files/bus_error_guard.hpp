/// Mapped files that another program makes shorter.
#pragma once

#include <cstddef>

namespace lab {

/// Guards a mapping of a file, from its first page on, against SIGBUS: what the file no longer has
/// reads as zeros, and the guard remembers it. Bus errors elsewhere are left to the handler that
/// the process had before.
class BusErrorGuard {
 public:
  /// A process guards up to 64 mappings at a time; further ones are not guarded.
  /// @param size > 0 [bytes]
  BusErrorGuard(void* mapping, std::size_t size);
  ~BusErrorGuard();
  BusErrorGuard(const BusErrorGuard&) = delete;
  BusErrorGuard& operator=(const BusErrorGuard&) = delete;

  /// Whether something was read that the file no longer has.
  [[nodiscard]] bool readZeros() const;

 private:
  struct Range;
  class Handler;
  Range* range_ = nullptr;
};

}  // namespace lab
