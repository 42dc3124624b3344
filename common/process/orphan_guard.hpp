/// Ends the children that a killed process leaves behind.
#pragma once

#include <sys/types.h>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// A death signal (ChildSettings) does not end every orphan: a process that is stopped, or that
/// hangs, does not act on SIGTERM, and SIGKILL would not let robot_bridge stop its robots or
/// the recorder write its data. So a small process waits for the end of this one. It then sends
/// SIGTERM and SIGCONT to the children that still run, and SIGKILL after kTimeout_ms.
class OrphanGuard {
 public:
  static constexpr int kTimeout_ms = 5000;

  /// Forks the guard. @throws std::system_error if there can be no more processes
  OrphanGuard();

  /// Ends the guard; children that still run are ended first.
  ~OrphanGuard();
  OrphanGuard(const OrphanGuard&) = delete;
  OrphanGuard& operator=(const OrphanGuard&) = delete;

  /// Watches one more child, which leads its process group.
  void watch(pid_t child);

 private:
  FileDescriptor pids_;  ///< pipe to the guard, which ends with this process
  pid_t guard_ = -1;
};

}  // namespace lab
