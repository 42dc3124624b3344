/// Logs as tables.
#pragma once

#include <cstdint>
#include <filesystem>
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

struct LogContents {
  std::vector<LoggedChannel> channels;  ///< in alphabetical order, known types first
  LogReadResult read;

  /// The channel's known type with most messages; nullptr: it has none.
  [[nodiscard]] const LoggedChannel* find(std::string_view channel) const;
};

/// Reads channels, types and times, but no contents.
/// @param files as logSeries() gives them
/// @throws std::runtime_error if a file cannot be read
[[nodiscard]] LogContents logContents(const std::vector<std::filesystem::path>& files);

struct LoadedTable {
  MessageTable table;
  std::int64_t undecodable = 0;  ///< messages of this type that are damaged, which are left out
};

/// The table of all messages of one channel and type. Reads the log twice, so that the table takes
/// no more memory than its numbers.
/// @param selection as for MessageTable
[[nodiscard]] LoadedTable loadTable(
    const std::vector<std::filesystem::path>& files, std::string_view channel, const Type& type,
    std::string_view path, const std::optional<std::vector<std::string>>& selection = std::nullopt);

}  // namespace lab::schema
