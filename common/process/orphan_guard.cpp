#include "common/process/orphan_guard.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <system_error>
#include <utility>

#include "common/process/file_descriptor.hpp"
#include "common/process/pidfd.hpp"
#include "common/process/pipe.hpp"

namespace lab {
namespace {

/// Children of a run: services and logger, each restarted now and then.
constexpr std::size_t kMostChildren = 128;

/// The children that run, as pidfds. A pid alone may be another process's by the time it is used.
struct Children {
  std::array<int, kMostChildren> descriptors{};
  std::size_t size = 0;

  void add(pid_t pid) {
    forgetEnded(0);
    const int descriptor = openPidfd(pid);
    if (descriptor < 0) return;
    if (size < kMostChildren) {
      descriptors[size++] = descriptor;
    } else {
      close(descriptor);
    }
  }

  /// Waits until one has ended, and forgets those that have.
  void forgetEnded(int timeout_ms) {
    std::array<pollfd, kMostChildren> entries{};
    for (std::size_t i = 0; i < size; ++i) entries[i] = {descriptors[i], POLLIN, 0};
    if (poll(entries.data(), size, timeout_ms) <= 0) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
      if (entries[i].revents == 0) {
        descriptors[kept++] = descriptors[i];
      } else {
        close(descriptors[i]);
      }
    }
    size = kept;
  }

  void signal(int number) const {
    for (std::size_t i = 0; i < size; ++i) signalPidfd(descriptors[i], number);
  }
};

std::int64_t steady_ms() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

/// The guard. It is forked from a process with threads, so it uses system calls only.
[[noreturn]] void guard(int pids) {
  setsid();  // neither Ctrl-C nor a signal to the group of the run reaches it
  prctl(PR_SET_NAME, "lab-guard");
  for (const int number : {SIGHUP, SIGINT, SIGTERM, SIGPIPE}) std::signal(number, SIG_IGN);
  if (pids != 0) dup2(pids, 0);
  closeFrom(1, Close::kNow);  // a reader of the run's output waits for no guard
  Children children;
  for (;;) {
    pid_t pid = 0;
    const ssize_t count = read(0, &pid, sizeof pid);
    if (count < 0 && errno == EINTR) continue;
    if (count != sizeof pid) break;
    children.add(pid);
  }
  children.forgetEnded(0);
  children.signal(SIGTERM);
  children.signal(SIGCONT);
  const std::int64_t deadline = steady_ms() + OrphanGuard::kTimeout_ms;
  for (std::int64_t left = OrphanGuard::kTimeout_ms; children.size > 0 && left > 0;
       left = deadline - steady_ms()) {
    children.forgetEnded(static_cast<int>(left));
  }
  children.signal(SIGKILL);
  _exit(0);
}

}  // namespace

OrphanGuard::OrphanGuard() {
  Pipe pipe = makePipe();
  guard_ = fork();
  if (guard_ == 0) guard(pipe.out.get());
  if (guard_ < 0) throw std::system_error(errno, std::generic_category(), "no guard process");
  pids_ = std::move(pipe.in);
}

OrphanGuard::~OrphanGuard() {
  pids_ = FileDescriptor();
  while (waitpid(guard_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void OrphanGuard::watch(pid_t child) {
  static_cast<void>(!write(pids_.get(), &child, sizeof child));
}

}  // namespace lab
