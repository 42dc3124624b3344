/// What happened in a live campaign, minute by minute. Pure functions on a file of JSON lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner::campaign {

/// One activity of a live campaign.
struct JournalEntry {
  enum class What {
    kRun,       ///< a run of the campaign
    kClear,     ///< the experiment that clears the arena
    kRest,      ///< the robots stand
    kWait,      ///< after a run that could not be played
    kTakeBack,  ///< all robots take part again
  };
  What what = What::kRun;
  std::int64_t begin_us = 0;  ///< UTC [us]
  std::int64_t end_us = 0;    ///< UTC [us]; 0: it was interrupted
  // Of a run:
  std::size_t row = 0;
  std::string identity{};                        ///< RunIdentity::text(): rows may be numbered anew
  bool kept = false;                             ///< its numbers are in the table
  std::vector<std::string> reasons{};            ///< why it is not
  std::map<std::int32_t, std::string> robots{};  ///< those that took part; problem, or empty

  bool operator==(const JournalEntry&) const = default;
};

/// A line of journal.jsonl, with its end of line. An entry without an end is written when the
/// activity begins, and again when it has ended.
[[nodiscard]] std::string journalLine(const JournalEntry& entry);

struct Journal {
  std::vector<JournalEntry> entries;
  std::size_t damaged_lines = 0;
};

/// Entries in the order of their begin. Lines that cannot be read are counted, and left out.
[[nodiscard]] Journal readJournal(std::string_view text);

/// How the time of a campaign was spent.
struct TimeAccount {
  double total_s = 0;   ///< from the first begin to `now` [s]
  double kept_s = 0;    ///< in runs whose numbers are in the table
  double marked_s = 0;  ///< in runs that were repeated or given up
  double lost_s = 0;    ///< in activities that were interrupted, up to the next begin
  double clear_s = 0;
  double rest_s = 0;
  double wait_s = 0;
  double idle_s = 0;  ///< between activities: no campaign was running, or it made its tables
};

[[nodiscard]] TimeAccount accountOf(const std::vector<JournalEntry>& entries);

/// "24 h 0 min: 93 % in runs that count, ..."
[[nodiscard]] std::string accountText(const TimeAccount& account);

}  // namespace lab::runner::campaign
