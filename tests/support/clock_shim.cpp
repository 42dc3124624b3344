// Preloaded (LD_PRELOAD) into the processes of a test: shifts their wall clock, and the times that
// the kernel gives datagrams, by the number of microseconds in the file LAB_CLOCK_FILE. Linux's
// time namespaces cannot shift CLOCK_REALTIME, and a test must not set the clock of the machine.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace {

using Shift = std::atomic<std::int64_t>;

/// The shift [us] in the shared file; nullptr without one.
const Shift* shift() {
  static const Shift* const mapped = []() -> const Shift* {
    const char* path = std::getenv("LAB_CLOCK_FILE");
    const int file = path == nullptr ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return nullptr;
    void* memory = mmap(nullptr, sizeof(Shift), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    return memory == MAP_FAILED ? nullptr : static_cast<const Shift*>(memory);
  }();
  return mapped;
}

std::int64_t shift_us() {
  const Shift* const now = shift();
  return now == nullptr ? 0 : now->load();
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static const auto real = next<int (*)(clockid_t, timespec*)>("clock_gettime");
  const int result = real(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) {
    constexpr std::int64_t kSecond_us = 1'000'000;
    time->tv_sec += shift_us() / kSecond_us;  // tests shift by whole seconds
  }
  return result;
}

extern "C" int recvmmsg(int socket, mmsghdr* messages, unsigned count, int flags,
                        timespec* timeout) {
  static const auto real = next<int (*)(int, mmsghdr*, unsigned, int, timespec*)>("recvmmsg");
  const int received = real(socket, messages, count, flags, timeout);
  for (int i = 0; i < received; ++i) {
    msghdr& header = messages[i].msg_hdr;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMP) continue;
      timeval time{};
      std::memcpy(&time, CMSG_DATA(c), sizeof time);
      time.tv_sec += shift_us() / 1'000'000;
      std::memcpy(CMSG_DATA(c), &time, sizeof time);
    }
  }
  return received;
}
