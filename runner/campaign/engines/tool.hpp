/// Calls programs of a site: sbatch, squeue, parallel, ssh.
#pragma once

#include <string>
#include <vector>

namespace lab::runner::campaign {

struct ToolEnd {
  int code = -1;
  std::string output;
  std::string errors;
  bool interrupted = false;  ///< the user ended it

  [[nodiscard]] bool ok() const { return code == 0 && !interrupted; }
  /// The last line of the errors, else of the output.
  [[nodiscard]] std::string lastLine() const;
};

/// Runs a program to its end, or until the user interrupts (wasInterrupted()). It cannot ask the
/// user: a program that waits on the network or for a password is ended by Ctrl-C only.
/// @throws UserError if it is not installed
[[nodiscard]] ToolEnd runTool(const std::vector<std::string>& arguments);

}  // namespace lab::runner::campaign
