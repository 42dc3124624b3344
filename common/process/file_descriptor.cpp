#include "common/process/file_descriptor.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace lab {

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

FileDescriptor::~FileDescriptor() {
  if (number_ >= 0) close(number_);
}

int FileDescriptor::release() { return std::exchange(number_, -1); }

void closeFrom(int first, Close when) {
  const int flags = when == Close::kAtExec ? CLOSE_RANGE_CLOEXEC : 0;
  if (close_range(static_cast<unsigned>(first), ~0U, flags) != 0) closeOneByOneFrom(first, when);
}

void closeOneByOneFrom(int first, Close when) {
  constexpr rlim_t kMost = 1U << 20U;
  rlimit limit{kMost, kMost};
  getrlimit(RLIMIT_NOFILE, &limit);
  const int end = static_cast<int>(std::min(limit.rlim_cur, kMost));
  for (int number = first; number < end; ++number) {
    when == Close::kAtExec ? fcntl(number, F_SETFD, FD_CLOEXEC) : close(number);
  }
}

}  // namespace lab
