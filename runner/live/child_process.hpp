/// A process that never outlives the runner.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "runner/live/service_process.hpp"

namespace lab::runner {

/// Starts a program in a process group of its own (a Ctrl-C in the terminal reaches the runner
/// alone, which ends its children in the right order), with SIGTERM sent by the kernel should the
/// runner die, and its output appended to a file.
class ChildProcess final : public ServiceProcess {
 public:
  /// Descriptors to talk through, which stay their owner's; -1: input is empty, output a file.
  struct Streams {
    int input = -1;
    int output = -1;
  };

  /// @param arguments the program's path first.
  /// @param output the file for what it prints, beyond what goes to a stream.
  /// @throws std::runtime_error when it cannot be started.
  ChildProcess(std::string name, const std::vector<std::string>& arguments,
               const std::filesystem::path& output, Streams streams);
  ChildProcess(std::string name, const std::vector<std::string>& arguments,
               const std::filesystem::path& output)
      : ChildProcess(std::move(name), arguments, output, Streams{}) {}
  ~ChildProcess() override;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

  [[nodiscard]] bool running() override;
  [[nodiscard]] int localPid() const override { return pid_; }
  [[nodiscard]] const std::string& ending() const override { return ending_; }
  void terminate() override;

  /// SIGKILL is never the first choice for lcm-logger.
  bool waitOrKill(int patience_ms) override;

 private:
  std::string name_;
  pid_t pid_ = -1;
  bool running_ = false;
  std::string ending_;
};

}  // namespace lab::runner
