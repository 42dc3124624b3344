#include "runner/campaign/live/live_journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/value_checker.hpp"
#include "common/text/format.hpp"
#include "common/text/json_text.hpp"
#include "runner/campaign/campaign.hpp"

namespace lab::runner::campaign {
namespace {

using What = JournalEntry::What;
using nlohmann::ordered_json;

constexpr std::array<std::pair<What, const char*>, 5> kWhats{{{What::kRun, "run"},
                                                              {What::kClear, "clear"},
                                                              {What::kRest, "rest"},
                                                              {What::kWait, "wait"},
                                                              {What::kTakeBack, "take back"}}};
constexpr double kSecond = 1e-6;  // [s/us]

std::optional<JournalEntry> entryOf(const std::string& line) {
  const auto read = parseJsonText(line);
  if (!read.is_object()) return {};
  try {
    JournalEntry entry;
    const auto what = read.at("what").get<std::string>();
    const auto* const known =
        std::ranges::find(kWhats, what, [](const auto& pair) { return std::string(pair.second); });
    if (known == kWhats.end()) return {};
    entry.what = known->first;
    const auto timeOf = [](const nlohmann::json& utime) {
      return wholeNumber<std::int64_t>(utime, 0, ValueChecker::kLatestUtime);
    };
    entry.begin_us = timeOf(read.at("begin_us"));
    if (read.contains("end_us")) entry.end_us = timeOf(read.at("end_us"));
    if (entry.what != What::kRun) return entry;
    entry.row = wholeNumber<std::size_t>(read.at("row"), 0, kMostRows);
    entry.identity = read.at("run").get<std::string>();
    entry.kept = read.value("kept", false);
    entry.reasons = read.value("reasons", std::vector<std::string>());
    for (const nlohmann::json& robot : read.at("robots")) {
      constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
      const auto id = wholeNumber<std::int32_t>(robot.at("robot"), 0, kLargest);
      entry.robots[id] = robot.value("problem", "");
    }
    return entry;
  } catch (const std::exception&) {  // of nlohmann::json, or of wholeNumber()
    return {};
  }
}

double secondsOf(const JournalEntry& entry) {
  return static_cast<double>(entry.end_us - entry.begin_us) * kSecond;
}

}  // namespace

std::string journalLine(const JournalEntry& entry) {
  const auto* const what =
      std::ranges::find(kWhats, entry.what, [](const auto& pair) { return pair.first; });
  ordered_json line{{"what", what->second}, {"begin_us", entry.begin_us}};
  if (entry.end_us != 0) line["end_us"] = entry.end_us;
  if (entry.what == What::kRun) {
    line["row"] = entry.row;
    line["run"] = entry.identity;
    if (entry.end_us != 0) line["kept"] = entry.kept;
    if (!entry.reasons.empty()) line["reasons"] = entry.reasons;
    line["robots"] = ordered_json::array();
    for (const auto& [id, problem] : entry.robots) {
      ordered_json robot{{"robot", id}};
      if (!problem.empty()) robot["problem"] = problem;
      line["robots"].push_back(std::move(robot));
    }
  }
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Journal readJournal(std::string_view text) {
  Journal journal;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string line(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty()) continue;
    const std::optional<JournalEntry> entry = entryOf(line);
    if (!entry) {
      ++journal.damaged_lines;
      continue;
    }
    const bool ends_last = !journal.entries.empty() && journal.entries.back().end_us == 0 &&
                           journal.entries.back().begin_us == entry->begin_us;
    if (ends_last) journal.entries.pop_back();
    journal.entries.push_back(*entry);
  }
  return journal;
}

TimeAccount accountOf(const std::vector<JournalEntry>& entries) {
  TimeAccount account;
  std::int64_t accounted_us = entries.empty() ? 0 : entries.front().begin_us;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const JournalEntry& entry = entries[i];
    account.idle_s +=
        static_cast<double>(std::max<std::int64_t>(0, entry.begin_us - accounted_us)) * kSecond;
    accounted_us = std::max(accounted_us, entry.begin_us);
    if (entry.end_us == 0) {
      const std::int64_t next_us = i + 1 < entries.size() ? entries[i + 1].begin_us : accounted_us;
      account.lost_s +=
          static_cast<double>(std::max<std::int64_t>(0, next_us - accounted_us)) * kSecond;
      accounted_us = std::max(accounted_us, next_us);
      continue;
    }
    const double seconds = secondsOf(entry);
    accounted_us = std::max(accounted_us, entry.end_us);
    switch (entry.what) {
      case What::kRun:
        (entry.kept ? account.kept_s : account.marked_s) += seconds;
        break;
      case What::kClear:
        account.clear_s += seconds;
        break;
      case What::kRest:
        account.rest_s += seconds;
        break;
      case What::kWait:
        account.wait_s += seconds;
        break;
      case What::kTakeBack:
        break;
    }
  }
  if (!entries.empty()) {
    account.total_s = static_cast<double>(accounted_us - entries.front().begin_us) * kSecond;
  }
  return account;
}

std::string accountText(const TimeAccount& account) {
  if (account.total_s <= 0) return "nothing was played yet";
  std::string text = durationText(account.total_s) + ":";
  bool first = true;
  const auto add = [&](double seconds, const char* name) {
    if (seconds <= 0) return;
    text += fmt::format("{} {} ({:.1f} %) {}", first ? "" : ",", durationText(seconds),
                        100 * seconds / account.total_s, name);
    first = false;
  };
  add(account.kept_s, "in runs that count");
  add(account.marked_s, "in runs that were marked");
  add(account.lost_s, "lost by interruptions");
  add(account.clear_s, "clearing the arena");
  add(account.rest_s, "resting");
  add(account.wait_s, "waiting after failures");
  add(account.idle_s, "between activities");
  return text;
}

}  // namespace lab::runner::campaign
