/// Processor time and memory of processes on this host.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lab::dashboard {

/// Counters of one process.
struct ProcessTimes {
  double cpu = 0;          ///< [s] user and system
  double memory = 0;       ///< [byte] resident
  std::int64_t begun = 0;  ///< start time; differs when a process id is used again
};

struct ProcessUse {
  double cpu_percent = 0;  ///< of one core
  double memory_MB = 0;
};

/// Reads them from /proc. @return nothing if there is no such process
[[nodiscard]] std::optional<ProcessTimes> readProcess(std::int32_t pid);

/// The name of this host; empty on errors.
[[nodiscard]] std::string ownHost();

/// Measures the use between two calls.
class ProcessMeter {
 public:
  using Read = std::function<std::optional<ProcessTimes>(std::int32_t pid)>;

  explicit ProcessMeter(Read read = readProcess) : read_(std::move(read)) {}

  /// The use since the previous call. For a new process only the memory is known and cpu_percent is
  /// nan.
  /// @param now of a steady clock [us]
  [[nodiscard]] std::map<std::int32_t, ProcessUse> measure(const std::vector<std::int32_t>& pids,
                                                           std::int64_t now);

 private:
  Read read_;
  std::map<std::int32_t, ProcessTimes> before_;
  std::int64_t before_utime_ = 0;
};

}  // namespace lab::dashboard
