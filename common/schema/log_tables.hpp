/// Logs as tables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/schema/message_table.hpp"
#include "common/schema/schema.hpp"

namespace lab::schema {

/// The messages of one type on one channel of a log.
struct LoggedChannel {
  std::string channel;
  const Type* type = nullptr;  ///< nullptr: unknown
  std::int64_t messages = 0;
  std::int64_t bytes = 0;        ///< of their encodings
  std::int64_t first_utime = 0;  ///< arrival of the first one
  std::int64_t last_utime = 0;
};

/// A log of which it is known where each message is, so that a channel is read without the others.
class LogIndex {
 public:
  /// Reads the log once, but not the contents of its messages.
  /// @param files as logSeries() gives them
  /// @throws std::runtime_error if a file cannot be read
  explicit LogIndex(std::vector<std::filesystem::path> files);

  /// In alphabetical order, known types first.
  [[nodiscard]] const std::vector<LoggedChannel>& channels() const { return channels_; }

  /// The channel's known type with most messages; nullptr: it has none.
  [[nodiscard]] const LoggedChannel* find(std::string_view channel) const;

  [[nodiscard]] const LogReadResult& result() const { return result_; }
  [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }

  /// Calls `take(number of the event, packet)` for every message of this channel and type.
  /// @throws std::runtime_error if a file cannot be read, or has become shorter
  void read(std::string_view channel, const Type& type,
            const std::function<void(std::int64_t, const Packet&)>& take) const;

 private:
  struct Entry {
    std::int64_t event;
    std::int64_t utime;
    std::uint64_t offset;
    std::uint32_t size;
    std::uint32_t file;
  };

  std::vector<std::filesystem::path> files_;
  std::vector<LoggedChannel> channels_;
  std::vector<std::vector<Entry>> entries_;  ///< of each of channels_
  LogReadResult result_;
};

/// What receivers of the lab would not use of the messages of one channel and type: what
/// checkEncoding() refuses or removes.
struct ChannelCheck {
  /// By the number of the event: the message without the robots that were removed; empty: nothing
  /// of the message is used.
  std::map<std::int64_t, std::vector<std::uint8_t>> changed{};
  std::int64_t undecodable = 0;  ///< messages that are damaged
  std::int64_t refused = 0;      ///< messages with impossible numbers
  std::int64_t removed = 0;      ///< robots and detections that were removed from other messages
  std::string first{};           ///< the first problem; empty: none
};

[[nodiscard]] ChannelCheck checkChannel(const LogIndex& log, std::string_view channel,
                                        const Type& type);

struct LoadedTable {
  MessageTable table;
  std::int64_t undecodable = 0;  ///< messages of this type that are damaged, which are left out
};

/// The table of all messages of one channel and type. It takes no more memory than its numbers.
/// @param selection as for MessageTable
/// @param check of this channel and type, whose changes are applied; nullptr: the table has all
/// that
///   was sent
[[nodiscard]] LoadedTable loadTable(
    const LogIndex& log, std::string_view channel, const Type& type, std::string_view path,
    const std::optional<std::vector<std::string>>& selection = std::nullopt,
    const ChannelCheck* check = nullptr);

}  // namespace lab::schema
