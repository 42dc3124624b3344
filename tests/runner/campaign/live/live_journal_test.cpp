#include "runner/campaign/live/live_journal.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

namespace lab::runner::campaign {
namespace {

using What = JournalEntry::What;

constexpr std::int64_t kSecond_us = 1'000'000;

JournalEntry entryOf(What what, double begin_s, double end_s) {
  JournalEntry entry;
  entry.what = what;
  entry.begin_us = static_cast<std::int64_t>(begin_s * kSecond_us);
  entry.end_us = static_cast<std::int64_t>(end_s * kSecond_us);
  return entry;
}

JournalEntry runOf(double begin_s, double end_s, bool kept) {
  JournalEntry entry = entryOf(What::kRun, begin_s, end_s);
  entry.row = 3;
  entry.identity = "0123-45";
  entry.kept = kept;
  entry.robots = {{1, ""}, {2, kept ? "" : "stalled"}};
  if (!kept) entry.reasons = {"robot 2 \"stalled\"\n", "the projector is silent"};
  return entry;
}

TEST(LiveJournal, ReadsWhatItWrites) {
  const std::vector<JournalEntry> entries{
      entryOf(What::kClear, 100, 160), entryOf(What::kRest, 160, 170), runOf(170, 230, false),
      runOf(240, 300, true), entryOf(What::kTakeBack, 301, 301)};
  std::string text;
  for (const JournalEntry& entry : entries) text += journalLine(entry);
  const Journal journal = readJournal(text);
  EXPECT_EQ(journal.entries, entries);
  EXPECT_EQ(journal.damaged_lines, 0U);
}

TEST(LiveJournal, TheLineOfTheEndReplacesThatOfTheBegin) {
  JournalEntry begun = runOf(170, 230, true);
  begun.end_us = 0;
  begun.kept = false;
  const Journal journal = readJournal(journalLine(begun) + journalLine(runOf(170, 230, true)));
  ASSERT_EQ(journal.entries.size(), 1U);
  EXPECT_EQ(journal.entries[0], runOf(170, 230, true));
}

TEST(LiveJournal, ImpossibleTimesAreDamage) {
  JournalEntry early = entryOf(What::kRest, 10, 20);
  early.begin_us = std::numeric_limits<std::int64_t>::min();
  JournalEntry late = entryOf(What::kRest, 10, 20);
  late.end_us = std::numeric_limits<std::int64_t>::max();
  const Journal journal = readJournal(journalLine(early) + journalLine(late));
  EXPECT_EQ(journal.entries.size(), 0U);
  EXPECT_EQ(journal.damaged_lines, 2U);
}

TEST(LiveJournal, NumbersThatAreNoWholeNumbersAreDamage) {
  const std::string good = journalLine(runOf(10, 20, true));
  for (const char* key : {"begin_us", "end_us", "row", "robot"}) {
    std::string line = good;
    const std::size_t begin = good.find(':', good.find("\"" + std::string(key) + "\"")) + 1;
    line.replace(begin, good.find_first_of(",}\n", begin) - begin, "1e300");
    EXPECT_EQ(readJournal(line).damaged_lines, 1U) << line;
  }
}

TEST(LiveJournal, DamagedLinesAreCountedAndLeftOut) {
  const std::string good = journalLine(runOf(10, 20, true));
  const Journal journal =
      readJournal(good + "{\"what\":\"run\",\"beg" + "\n" + "{\"what\":\"run\"}\n" + "[1,2]\n" +
                  good.substr(0, good.size() / 2));
  EXPECT_EQ(journal.entries.size(), 1U);
  EXPECT_EQ(journal.damaged_lines, 4U);
}

TEST(LiveJournal, AccountsForEverySecond) {
  JournalEntry lost = runOf(400, 0, false);
  lost.end_us = 0;
  const TimeAccount account = accountOf(
      {entryOf(What::kClear, 100, 160), entryOf(What::kRest, 160, 190), runOf(190, 250, true),
       runOf(260, 320, false), entryOf(What::kWait, 320, 400), lost, runOf(1000, 1060, true)});
  EXPECT_DOUBLE_EQ(account.kept_s, 120);
  EXPECT_DOUBLE_EQ(account.marked_s, 60);
  EXPECT_DOUBLE_EQ(account.clear_s, 60);
  EXPECT_DOUBLE_EQ(account.rest_s, 30);
  EXPECT_DOUBLE_EQ(account.wait_s, 80);
  EXPECT_DOUBLE_EQ(account.lost_s, 600);
  EXPECT_DOUBLE_EQ(account.idle_s, 10);
  EXPECT_DOUBLE_EQ(account.total_s, 960);
  EXPECT_DOUBLE_EQ(account.kept_s + account.marked_s + account.clear_s + account.rest_s +
                       account.wait_s + account.lost_s + account.idle_s,
                   account.total_s);
}

}  // namespace
}  // namespace lab::runner::campaign
