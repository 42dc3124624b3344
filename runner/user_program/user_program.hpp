/// A program of the user that takes part in a run (`lab run FILE --with script.py`).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/process/child_process.hpp"

namespace lab::runner {

/// What is started.
struct UserProgram {
  std::string name;                    ///< of its file
  std::vector<std::string> arguments;  ///< the program first, a path or a name in PATH
  std::size_t file = 0;                ///< index of the user's file in `arguments`
  std::string digest;                  ///< SHA-256 of its file
};

/// Splits what the user typed: a file, or a file and its arguments, separated by blanks. A file
/// whose name ends with .py is executed by python3.
/// @throws UserError if there is no such file, or it cannot be executed
[[nodiscard]] UserProgram findUserProgram(const std::string& typed);

/// Copies its file into the folder of the run, where it belongs to the record.
/// @throws UserError when it cannot be copied
void adoptUserProgram(const UserProgram& program, const std::filesystem::path& run);

/// Remark for the record: name, arguments, digest.
[[nodiscard]] std::string describe(const UserProgram& program);

/// The lab waits for a user program for this long before it says so.
constexpr std::chrono::seconds kSilentWait{5};

/// The process of a user program. Its output goes to the terminal.
class UserProcess {
 public:
  /// @param environment "NAME=value", besides that of this process
  /// @param handed_on as in ChildSettings
  /// @throws UserError when it cannot be started
  UserProcess(const UserProgram& program, const std::filesystem::path& run,
              std::vector<std::string> environment,
              std::vector<std::pair<int, int>> handed_on = {});

  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] bool running() { return child_->running(); }

  /// Waits for its end, for as long as it takes, unless the user is in a hurry: then it gets
  /// SIGTERM after 2 s, and SIGKILL after 2 s more. Says after kSilentWait that it waits.
  void waitForEnd(const std::function<bool()>& in_a_hurry);

  /// What went wrong, for the record; empty: it runs, or ended with 0.
  [[nodiscard]] std::string problem() const;

 private:
  std::string name_;
  std::unique_ptr<ChildProcess> child_;
};

}  // namespace lab::runner
