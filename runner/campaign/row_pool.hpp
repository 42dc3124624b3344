/// Runs rows in child processes, some at a time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/process/file_descriptor.hpp"

namespace lab::runner::campaign {

/// How a row ended.
struct RowEnd {
  enum class Kind { kDone, kFailed, kDiskFull, kKilled };
  std::size_t row = 0;
  Kind kind = Kind::kDone;
  std::string reason;           ///< one line, unless done
  double seconds = 0;           ///< [s] of the wall clock
  std::int64_t peak_bytes = 0;  ///< of memory
};

/// Forks a child for each row, so that a run that crashes, or takes all memory, ends alone. As many
/// run at a time as there are jobs, as long as the memory that is free has room for one more of the
/// largest so far. Children end with the pool, also when it is killed.
class RowPool {
 public:
  /// Runs a row in a child. What it throws is the reason of the failure.
  using Work = std::function<void(std::size_t row)>;

  /// @param scratch folder for the children's messages
  RowPool(std::size_t jobs, std::filesystem::path scratch, Work work)
      : jobs_(jobs), scratch_(std::move(scratch)), work_(std::move(work)) {}
  ~RowPool();
  RowPool(const RowPool&) = delete;
  RowPool& operator=(const RowPool&) = delete;

  void add(std::size_t row) { waiting_.push_back(row); }

  /// Starts what there is room for, and waits at most so long for ends.
  std::vector<RowEnd> wait(std::chrono::milliseconds timeout);

  /// Forgets the rows that have not begun.
  void drop() { waiting_.clear(); }

  /// Kills what runs.
  void kill();

  [[nodiscard]] bool empty() const { return waiting_.empty() && running_.empty(); }
  [[nodiscard]] std::size_t running() const { return running_.size(); }

 private:
  struct Child {
    std::size_t row = 0;
    pid_t pid = -1;
    FileDescriptor ended;  ///< a pidfd
    std::filesystem::path messages;
    std::chrono::steady_clock::time_point begin;
  };

  void start();
  [[nodiscard]] bool hasRoom() const;
  [[nodiscard]] RowEnd reap(const Child& child);

  std::size_t jobs_;
  std::filesystem::path scratch_;
  Work work_;
  std::deque<std::size_t> waiting_;
  std::vector<Child> running_;
  std::int64_t largest_bytes_ = 0;
};

/// Memory that processes may still take [bytes]; 0: not known.
[[nodiscard]] std::int64_t availableMemory_bytes();

/// The last line of what a child process wrote: mostly its error. Printable.
[[nodiscard]] std::string lastLine(const std::filesystem::path& messages);

}  // namespace lab::runner::campaign
