#include "common/files/truncation_guard.hpp"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>

namespace lab {

struct TruncationGuard::Range {
  std::atomic<bool> taken = false;
  std::atomic<char*> begin = nullptr;
  std::atomic<char*> end = nullptr;
  std::atomic<bool> found_truncation = false;
};

/// The signal's handler may run in any thread, and may only use atomics and system calls.
class TruncationGuard::Handler {
 public:
  static Range* add(char* begin, std::size_t size) {
    install();
    for (Range& range : ranges_) {
      if (range.taken.exchange(true)) continue;
      range.found_truncation = false;
      range.end = begin + size;
      range.begin = begin;
      return &range;
    }
    return nullptr;
  }

  static void remove(Range& range) {
    range.begin = nullptr;
    range.taken = false;
  }

 private:
  /// Others may have set a handler of their own since the last range.
  static void install() {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    struct sigaction now {};
    ::sigaction(SIGBUS, nullptr, &now);
    if ((now.sa_flags & SA_SIGINFO) != 0 && now.sa_sigaction == &handle) return;
    previous_ = now;
    struct sigaction mine {};
    mine.sa_sigaction = &handle;
    mine.sa_flags = SA_SIGINFO;
    ::sigaction(SIGBUS, &mine, nullptr);
  }

  static void handle(int /*signal*/, siginfo_t* error, void* /*context*/) {
    char* const at = static_cast<char*>(error->si_addr);
    for (Range& range : ranges_) {
      char* const begin = range.begin;
      char* const end = range.end;
      if (begin == nullptr || at < begin || at >= end) continue;
      const std::ptrdiff_t page_bytes = ::sysconf(_SC_PAGESIZE);
      char* const page = begin + (at - begin) / page_bytes * page_bytes;
      if (::mmap(page, static_cast<std::size_t>(end - page), PROT_READ,
                 MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == MAP_FAILED) {
        break;
      }
      range.found_truncation = true;
      return;
    }
    // The access is tried again, and the previous handler gets the error.
    ::sigaction(SIGBUS, &previous_, nullptr);
  }

  static std::array<Range, 64> ranges_;
  static struct sigaction previous_;
};

std::array<TruncationGuard::Range, 64> TruncationGuard::Handler::ranges_;
struct sigaction TruncationGuard::Handler::previous_ {};

TruncationGuard::TruncationGuard(void* mapping, std::size_t size)
    : range_(Handler::add(static_cast<char*>(mapping), size)) {}

TruncationGuard::~TruncationGuard() {
  if (range_ != nullptr) Handler::remove(*range_);
}

bool TruncationGuard::foundTruncation() const {
  return range_ != nullptr && range_->found_truncation;
}

}  // namespace lab
