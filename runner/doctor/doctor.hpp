/// `lab doctor`: problems of this machine and the commands that fix them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "runner/doctor/machine.hpp"

namespace lab::runner {

struct Finding {
  enum class Level : std::int8_t { kOk, kWarning, kError };
  Level level = Level::kOk;
  std::string what;  ///< what was found, in one line
  std::string fix;   ///< command to type; empty if there is nothing to fix
};

struct DoctorOptions {
  std::filesystem::path runs = "runs";  ///< folder for the runs
  std::filesystem::path registrations;  ///< registryDirectory(); not checked if empty
};

/// Derives the findings from the facts (pure function). At least one finding per subject, always in
/// the same order.
[[nodiscard]] std::vector<Finding> judge(const MachineFacts& facts, const DoctorOptions& options);

/// survey() and judge() of this machine.
[[nodiscard]] std::vector<Finding> examine(const DoctorOptions& options);

/// Prints one line per finding (ok, warn, FIX), and below it the command that fixes it.
void print(std::ostream& out, const std::vector<Finding>& findings);

/// 2 if a finding is an error, otherwise 0.
[[nodiscard]] int exitCode(const std::vector<Finding>& findings);

}  // namespace lab::runner
