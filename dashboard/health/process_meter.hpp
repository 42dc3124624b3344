/// What processes of this machine use.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lab::dashboard {

/// One process so far.
struct ProcessTimes {
  double cpu = 0;          ///< [s] user and system
  double memory = 0;       ///< [byte] resident
  std::int64_t begun = 0;  ///< tells two processes of one number apart
};

struct ProcessUse {
  double cpu_percent = 0;  ///< of one core
  double memory_MB = 0;
};

/// From Linux's /proc; nothing: there is no such process.
[[nodiscard]] std::optional<ProcessTimes> readProcess(std::int32_t pid);

/// "" where the name cannot be had.
[[nodiscard]] std::string ownHost();

class ProcessMeter {
 public:
  using Read = std::function<std::optional<ProcessTimes>(std::int32_t pid)>;

  explicit ProcessMeter(Read read = readProcess) : read_(std::move(read)) {}

  /// Since the call before; of a process that is new, its memory alone (cpu_percent: nan).
  /// @param now of a steady clock [us]
  [[nodiscard]] std::map<std::int32_t, ProcessUse> measure(const std::vector<std::int32_t>& pids,
                                                           std::int64_t now);

 private:
  Read read_;
  std::map<std::int32_t, ProcessTimes> before_;
  std::int64_t before_utime_ = 0;
};

}  // namespace lab::dashboard
