/// Message logs in the format of lcm-logger.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab {

/// Writes a log file as lcm-logger would.
class LogWriter {
 public:
  /// @throws std::runtime_error if the file exists (logs are never overwritten) or cannot be
  /// created
  explicit LogWriter(const std::filesystem::path& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// @throws std::runtime_error if the disk is full or gone
  void write(const Packet& packet);

  /// Writes all buffered data to the file. The destructor does the same, but cannot report errors.
  /// @throws std::runtime_error if the disk is full or gone
  void flush();

 private:
  struct Implementation;
  [[noreturn]] void fail() const;

  std::unique_ptr<Implementation> implementation_;
  std::filesystem::path path_;
};

/// The outcome of reading a log.
struct LogReadResult {
  std::int64_t events = 0;
  std::int64_t resyncs = 0;    ///< damaged places that were skipped, including a truncated end
  std::int64_t bad_times = 0;  ///< events whose time of arrival was damaged
};

/// Where the message of an event is, as it was logged.
struct LogPosition {
  std::size_t file = 0;  ///< index
  std::uint64_t offset = 0;
  std::size_t size = 0;
};

/// Reads the events of log files one by one, in the order of the files. LCM's own reader stops at
/// the first damaged byte, or skips good events after a damaged length. This one continues at the
/// next whole event and counts the damaged place. Messages of older contract versions are converted
/// to the present one. A damaged time of arrival is replaced by that of the event before; times are
/// from 0 to ValueChecker::kLatestUtime, and step only where the logger's clock did, or where the
/// bus was silent.
class LogReader {
 public:
  explicit LogReader(std::vector<std::filesystem::path> files);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// @return the next event, valid until the next call; nothing at the end
  /// @throws std::runtime_error if a file cannot be opened or read
  std::optional<Packet> next();

  /// The counts so far.
  [[nodiscard]] const LogReadResult& result() const;

  /// Of the last event.
  [[nodiscard]] const LogPosition& position() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Calls `handler` for every event that LogReader gives.
/// @throws std::runtime_error if a file cannot be opened or read
LogReadResult readLog(const std::vector<std::filesystem::path>& files,
                      const PacketHandler& handler);

/// Whether the file is regular and the sync word of an event is in its first 64 KiB. The first
/// event may be damaged.
[[nodiscard]] bool isLog(const std::filesystem::path& file);

/// The files of one log, in order: log.lcmlog, then log.lcmlog.01, log.lcmlog.02 ..., which loggers
/// write that were restarted during the run.
std::vector<std::filesystem::path> logSeries(const std::filesystem::path& first);

}  // namespace lab
