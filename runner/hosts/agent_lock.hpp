/// Who alone drives the robots of a run on one host.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace lab::runner {

/// One agent for each host of a run: one whose connection is lost does not know it yet when the
/// runner calls again, and still drives the robots. The newcomer ends it (SIGTERM, after a while
/// SIGKILL) and waits until it is gone; of several newcomers one drives at a time.
class AgentLock {
 public:
  /// @param name of run and host
  /// @throws UserError when the other does not end, or the lock cannot be written.
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
