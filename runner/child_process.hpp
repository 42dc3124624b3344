/// A process that never outlives the runner.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lab::runner {

/// Starts a program in a process group of its own (a Ctrl-C in the terminal reaches the runner
/// alone, which ends its children in the right order), with SIGTERM sent by the kernel should the
/// runner die, and its output appended to a file.
class ChildProcess {
 public:
  /// @param arguments the program's path first.
  /// @throws std::runtime_error when it cannot be started.
  ChildProcess(std::string name, const std::vector<std::string>& arguments,
               const std::filesystem::path& output);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// Whether it still runs; takes note of its end.
  [[nodiscard]] bool running();

  /// "killed by signal 9", "exit code 1" once it has ended.
  [[nodiscard]] const std::string& ending() const { return ending_; }

  /// Asks it to end (SIGTERM), without waiting.
  void terminate();

  /// Waits this long for its end, then SIGKILL. Never the first choice for lcm-logger.
  void waitOrKill(int patience_ms);

 private:
  std::string name_;
  pid_t pid_ = -1;
  bool running_ = false;
  std::string ending_;
};

}  // namespace lab::runner
