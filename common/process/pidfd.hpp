/// Descriptors of processes. <sys/pidfd.h> of glibc 2.36 cannot be used from C++: it lacks
/// extern "C".
#pragma once

#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

namespace lab {

/// @return a descriptor that is readable once the process has ended; -1 and errno: an error
inline int openPidfd(pid_t pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

inline void signalPidfd(int descriptor, int number) {
  syscall(SYS_pidfd_send_signal, descriptor, number, nullptr, 0);
}

}  // namespace lab
