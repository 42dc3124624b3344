/// A child process that never outlives the runner.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "runner/live/service_process.hpp"

namespace lab::runner {

/// Starts a program and appends its output to a file. The program has its own process group, so
/// that Ctrl-C reaches the runner only, which ends its children in the right order. The kernel
/// sends it SIGTERM when the runner dies.
class ChildProcess final : public ServiceProcess {
 public:
  /// Descriptors for stdin and stdout, not owned. -1: empty input, output to the file.
  struct Streams {
    int input = -1;
    int output = -1;
  };

  /// @param arguments the program's path first
  /// @param output file for stderr, and for stdout without a stream
  /// @throws std::runtime_error when it cannot be started
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

  /// lcm-logger must get time to write its data: SIGKILL would lose it.
  bool waitOrKill(int patience_ms) override;

 private:
  std::string name_;
  pid_t pid_ = -1;
  bool running_ = false;
  std::string ending_;
};

}  // namespace lab::runner
