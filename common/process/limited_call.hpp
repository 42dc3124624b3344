/// Work on foreign data with a library that may crash on it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace lab {

struct CallLimits {
  std::chrono::seconds processor{30};  ///< time that it computes
  std::uint64_t memory_bytes = 1'000'000'000;
  std::uint64_t file_bytes = 1'000'000'000;  ///< of each file that it writes
};

/// Runs `work` in a copy of this process and waits for its end. What it changes in memory is lost.
/// To be called while this process has one thread. When this process is asked to end meanwhile
/// (SIGINT, SIGTERM, SIGHUP), the copy is ended first, so that the caller can clean up.
/// @returns what `work` returned
/// @throws std::runtime_error with the message that `work` threw, or how it ended: "the reader was
/// killed by signal 11 (Segmentation fault)", "found no end after 30 s of computing"
[[nodiscard]] std::string callLimited(const CallLimits& limits,
                                      const std::function<std::string()>& work);

/// From now on this process can open no file. For the work of callLimited(), once it has opened its
/// own files: a library cannot follow a path that its data name.
void refuseFurtherFiles();

}  // namespace lab
