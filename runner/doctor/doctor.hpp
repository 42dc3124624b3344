/// `lab doctor`: what is wrong with this machine, and the line that repairs it.
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
  std::string fix;   ///< the line to type; empty: there is nothing to do
};

struct DoctorOptions {
  std::filesystem::path runs = "runs";  ///< where runs are written
  std::filesystem::path registrations;  ///< registryDirectory(); empty: not examined
};

/// The judgement: numbers in, sentences out. One finding at least a subject, always in one order.
[[nodiscard]] std::vector<Finding> judge(const MachineFacts& facts, const DoctorOptions& options);

/// Surveys this machine and judges it.
[[nodiscard]] std::vector<Finding> examine(const DoctorOptions& options);

/// One line a finding (ok, warn, FIX), below it the line that repairs it.
void print(std::ostream& out, const std::vector<Finding>& findings);

/// 0 when a lab can run (warnings or not), 2 when it cannot.
[[nodiscard]] int exitCode(const std::vector<Finding>& findings);

}  // namespace lab::runner
