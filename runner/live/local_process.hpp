/// A process of a run on this machine.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/process/child_process.hpp"
#include "runner/live/service_process.hpp"

namespace lab::runner {

/// Starts a program and appends its output to a file. The program has its own process group, so
/// that Ctrl-C reaches the runner only, which ends its children in the right order.
class LocalProcess final : public ServiceProcess {
 public:
  /// How it ends if the runner is killed.
  enum class Death {
    kTerm,  ///< SIGTERM: robots stop, the recorder writes its data. Needs an OrphanGuard
    kKill   ///< SIGKILL: for what has nothing to close
  };

  /// @param arguments the program's path first
  /// @param output file for its output
  /// @throws std::runtime_error when no process can be started or the file cannot be written
  LocalProcess(const std::vector<std::string>& arguments, const std::filesystem::path& output,
               Death death = Death::kTerm);
  ~LocalProcess() override;

  [[nodiscard]] pid_t pid() const { return child_ ? child_->pid() : 0; }

  [[nodiscard]] bool running() override;
  [[nodiscard]] int localPid() const override { return pid(); }
  [[nodiscard]] const std::string& ending() const override { return ending_; }
  void terminate() override;
  void kill();

  /// The recorder must get time to write its data: SIGKILL would lose it.
  bool waitOrKill(int timeout_ms) override;

 private:
  std::optional<ChildProcess> child_;  ///< none: the program could not be executed
  std::string ending_;
};

}  // namespace lab::runner
