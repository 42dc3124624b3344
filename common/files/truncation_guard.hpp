/// Mapped files that another program truncates.
#pragma once

#include <cstddef>

namespace lab {

/// Guards a mapping that begins at a page against SIGBUS: what the file no longer has reads as
/// zeros, and the guard remembers it. SIGBUS of other places is left to the handler that the
/// process had before.
class TruncationGuard {
 public:
  /// A process guards up to 64 mappings at a time; further ones are not guarded.
  /// @param size > 0 [bytes]
  TruncationGuard(void* mapping, std::size_t size);
  ~TruncationGuard();
  TruncationGuard(const TruncationGuard&) = delete;
  TruncationGuard& operator=(const TruncationGuard&) = delete;

  /// Whether something was read that the file no longer has.
  [[nodiscard]] bool foundTruncation() const;

 private:
  struct Range;
  class Handler;
  Range* range_ = nullptr;
};

}  // namespace lab
