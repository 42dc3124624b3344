/// Lock that allows one agent per host and run.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace lab::runner {

/// Ensures that one agent per host commands the robots of a run. When the runner reconnects after a
/// lost connection, the previous agent may still run. The new agent ends it (SIGTERM every second,
/// SIGKILL after 10 s) and waits until it has released the lock. If several agents wait, one gets
/// the lock at a time.
class AgentLock {
 public:
  /// Waits for the lock. @param name identifies run and host
  /// @throws UserError if the other agent does not end within 20 s or the file cannot be written
  explicit AgentLock(const std::string& name);
  ~AgentLock();
  AgentLock(const AgentLock&) = delete;
  AgentLock& operator=(const AgentLock&) = delete;

 private:
  void open();
  [[nodiscard]] bool holds() const;
  [[nodiscard]] pid_t holder() const;

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace lab::runner
