/// Which channels of a log become tables of an export, and what is left out. A log may come from a
/// stranger: its channels have names of any bytes, and tables have names of files.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/schema/log_tables.hpp"

namespace lab::runner {

/// What the tables of an export lack of a log.
struct LeftOut {
  std::int64_t messages = 0;  ///< damaged ones, and those of unknown types
  /// Number of messages on each channel whose name no table can have.
  std::map<std::string, std::int64_t, std::less<>> channels{};

  /// Counts a message that is in no table, or not in all of them.
  void count(std::string_view channel);
};

/// "3 messages on 2 channels left out: ...", with the names of the first channels; empty: there are
/// none. The text is one line that a terminal may show.
[[nodiscard]] std::string channelsText(const LeftOut& left_out);

struct TableChannels {
  std::vector<schema::LoggedChannel> kept{};  ///< of known types; as in LogIndex::channels()
  LeftOut left_out{};                         ///< channels, without their messages
};

/// The channels of a log that become tables. Their names have 1 to 63 letters, digits, '_', '.' and
/// '-', and do not begin with a dot, so that they lead to no other folder. No two tables have the
/// same name: the first keeps it.
/// @param taken names that no table may have
[[nodiscard]] TableChannels tableChannels(const schema::LogIndex& log, std::set<std::string> taken);

/// The name of the table of one of schema::tablePaths(): "CHANNEL", "CHANNEL.robots".
[[nodiscard]] std::string tableTitle(std::string_view channel, std::string_view path);

}  // namespace lab::runner
