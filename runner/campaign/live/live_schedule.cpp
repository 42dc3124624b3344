#include "runner/campaign/live/live_schedule.hpp"

#include <algorithm>

#include "common/math/random.hpp"

namespace lab::runner::campaign {

LiveSchedule::LiveSchedule(const LivePlan& plan, const std::vector<Row>& rows,
                           const std::vector<std::size_t>& open, std::uint64_t seed)
    : plan_(plan), rows_(rows), queue_(open) {
  // A row's place depends on nothing but its identity: a restart keeps the order.
  std::ranges::sort(queue_, {}, [&](std::size_t row) {
    const std::uint64_t place = deriveSeed(seed, 0, "order " + rows[row].identity.text());
    return std::pair(rows[row].replicate, place);
  });
}

void LiveSchedule::take(const JournalEntry& entry) {
  if (entry.what == JournalEntry::What::kTakeBack) {
    strikes_.clear();
    left_out_.clear();
  }
  if (entry.what != JournalEntry::What::kRun || entry.end_us == 0) return;
  ++tries_[entry.identity];
  for (const auto& [id, problem] : entry.robots) {
    std::int64_t& strikes = strikes_[id];
    strikes = problem.empty() ? 0 : strikes + 1;
    if (strikes >= plan_.strikes) left_out_[id] = problem;
  }
  const auto played = std::ranges::find(
      queue_, entry.identity, [&](std::size_t row) { return rows_[row].identity.text(); });
  if (played == queue_.end()) return;
  const std::size_t row = *played;
  queue_.erase(played);
  if (entry.kept) return;
  const auto after = std::ranges::find_if(
      queue_, [&](std::size_t other) { return rows_[other].replicate > rows_[row].replicate; });
  queue_.insert(after, row);
}

std::optional<std::size_t> LiveSchedule::next() const {
  if (queue_.empty()) return {};
  return queue_.front();
}

void LiveSchedule::closePoint(std::size_t point) {
  std::erase_if(queue_, [&](std::size_t row) { return rows_[row].point == point; });
}

void LiveSchedule::giveUp(std::size_t row) { std::erase(queue_, row); }

std::int64_t LiveSchedule::triesOf(std::size_t row) const {
  const auto tries = tries_.find(rows_[row].identity.text());
  return tries == tries_.end() ? 0 : tries->second;
}

}  // namespace lab::runner::campaign
