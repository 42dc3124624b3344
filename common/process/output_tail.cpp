#include "common/process/output_tail.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace lab {

void OutputTail::open(FileDescriptor pipe) {
  pipe_ = std::move(pipe);
  kept_.clear();
  fcntl(pipe_.get(), F_SETFL, fcntl(pipe_.get(), F_GETFL) | O_NONBLOCK);
}

void OutputTail::take() {
  std::array<char, 4096> buffer;
  // A pipe holds 64 kB: this returns even if the child prints all the time.
  for (int piece = 0; piece < 16 && pipe_.get() >= 0; ++piece) {
    const ssize_t count = read(pipe_.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return;
    if (count <= 0) {
      close();
      return;
    }
    kept_.append(buffer.data(), static_cast<std::size_t>(count));
    if (kept_.size() >= 2 * most_) kept_.erase(0, kept_.size() - most_);
  }
}

std::string OutputTail::text() const {
  return kept_.substr(kept_.size() - std::min(kept_.size(), most_));
}

}  // namespace lab
