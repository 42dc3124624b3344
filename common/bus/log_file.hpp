/// Logs in stock lcm-logger's format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab {

/// Writes what lcm-logger would have written.
class LogWriter {
 public:
  /// @throws std::runtime_error when the file exists (nothing is overwritten) or cannot be made.
  explicit LogWriter(const std::filesystem::path& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// @throws std::runtime_error when the disk takes no more.
  void write(const Packet& packet);

  /// Hands everything written so far to the system: what the destructor does without a word.
  /// @throws std::runtime_error when the disk takes no more.
  void flush();

 private:
  struct Implementation;
  [[noreturn]] void fail() const;

  std::unique_ptr<Implementation> implementation_;
  std::filesystem::path path_;
};

/// What reading a log came to.
struct LogReadResult {
  std::int64_t events = 0;
  std::int64_t resyncs = 0;  ///< damaged places that were skipped, a truncated end included
};

/// Calls `handler` for every event of the files, in the files' order. LCM's reader gives up at the
/// first damaged byte, and a damaged length makes it swallow what follows; this goes on at the next
/// whole event and counts the place. Messages of older contract versions come as this version
/// writes them.
/// @throws std::runtime_error when a file cannot be opened or read.
LogReadResult readLog(const std::vector<std::filesystem::path>& files,
                      const PacketHandler& handler);

/// The files of one log, in order: log.lcmlog, then log.lcmlog.01, log.lcmlog.02 ... which a
/// restarted logger wrote.
std::vector<std::filesystem::path> logSeries(const std::filesystem::path& first);

}  // namespace lab
