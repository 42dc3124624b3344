/// Calls programs of a site: sbatch, squeue, parallel, ssh.
#pragma once

#include <string>
#include <vector>

namespace lab::runner::campaign {

struct ToolEnd {
  int code = -1;
  std::string output;
  std::string errors;

  [[nodiscard]] bool ok() const { return code == 0; }
  /// The last line of the errors, else of the output.
  [[nodiscard]] std::string lastLine() const;
};

/// Runs a program to its end. @throws UserError if it is not installed
[[nodiscard]] ToolEnd runTool(const std::vector<std::string>& arguments);

}  // namespace lab::runner::campaign
