#include "runner/campaign/live/live_schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace lab::runner::campaign {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

std::vector<Row> rowsOfCampaign(std::size_t points, std::int64_t replicates) {
  std::vector<Row> rows;
  for (std::int64_t replicate = 0; replicate < replicates; ++replicate) {
    for (std::size_t point = 0; point < points; ++point) {
      rows.push_back({point, replicate, 1, {"row" + std::to_string(rows.size()), "m"}});
    }
  }
  return rows;
}

std::vector<std::size_t> all(const std::vector<Row>& rows) {
  std::vector<std::size_t> numbers(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) numbers[i] = i;
  return numbers;
}

JournalEntry played(const std::vector<Row>& rows, std::size_t row,
                    std::map<std::int32_t, std::string> robots = {}) {
  JournalEntry entry;
  entry.begin_us = 1;
  entry.end_us = 2;
  entry.row = row;
  entry.identity = rows[row].identity.text();
  entry.kept = std::ranges::all_of(robots, [](const auto& robot) { return robot.second.empty(); });
  entry.robots = std::move(robots);
  return entry;
}

std::vector<std::size_t> orderOf(LiveSchedule schedule, const std::vector<Row>& rows) {
  std::vector<std::size_t> order;
  while (const auto row = schedule.next()) {
    order.push_back(*row);
    schedule.take(played(rows, *row));
  }
  return order;
}

class Schedule : public testing::Test {
 protected:
  LivePlan plan_;
  std::vector<Row> rows_ = rowsOfCampaign(10, 2);
  LiveSchedule schedule_{plan_, rows_, all(rows_), 7};
};

TEST_F(Schedule, PlaysTheFirstRunsOfAllPointsInRandomOrderThenTheSecondOnes) {
  const std::vector<std::size_t> order = orderOf(schedule_, rows_);
  ASSERT_EQ(order.size(), 20U);
  EXPECT_TRUE(
      std::ranges::all_of(order.begin(), order.begin() + 10, [](auto row) { return row < 10; }));
  EXPECT_FALSE(std::ranges::is_sorted(order.begin(), order.begin() + 10));
  EXPECT_FALSE(std::ranges::is_sorted(order.begin() + 10, order.end()));
  const LiveSchedule other(plan_, rows_, all(rows_), 8);
  EXPECT_NE(orderOf(other, rows_), order);
}

TEST_F(Schedule, ARestartKeepsTheOrderOfWhatIsLeft) {
  std::vector<std::size_t> order = orderOf(schedule_, rows_);
  const std::size_t first = order.front();
  order.erase(order.begin());
  std::vector<std::size_t> open = all(rows_);
  std::erase(open, first);
  EXPECT_EQ(orderOf(LiveSchedule(plan_, rows_, open, 7), rows_), order);
}

TEST_F(Schedule, AMarkedRunComesAgainAfterTheOthersOfItsTurn) {
  const std::size_t first = schedule_.next().value();
  schedule_.take(played(rows_, first, {{1, "stalled"}}));
  EXPECT_EQ(schedule_.triesOf(first), 1);
  const std::vector<std::size_t> order = orderOf(schedule_, rows_);
  ASSERT_EQ(order.size(), 20U);
  EXPECT_EQ(order[9], first);
}

TEST_F(Schedule, LeavesOutARobotWithProblemsInTwoRunsInARow) {
  schedule_.take(played(rows_, 0, {{1, "stalled"}, {2, ""}, {3, "rebooted"}}));
  EXPECT_THAT(schedule_.leftOut(), IsEmpty());
  schedule_.take(played(rows_, 1, {{1, "vanished"}, {2, ""}, {3, ""}}));
  EXPECT_THAT(schedule_.leftOut(), ElementsAre(Pair(1, "vanished")));
  schedule_.take(played(rows_, 2, {{2, ""}, {3, "rebooted"}}));
  EXPECT_THAT(schedule_.leftOut(), ElementsAre(Pair(1, "vanished")));
  JournalEntry back;
  back.what = JournalEntry::What::kTakeBack;
  schedule_.take(back);
  EXPECT_THAT(schedule_.leftOut(), IsEmpty());
}

TEST_F(Schedule, AnInterruptedRunIsNoTry) {
  const std::size_t first = schedule_.next().value();
  JournalEntry lost = played(rows_, first, {{1, "stalled"}});
  lost.end_us = 0;
  schedule_.take(lost);
  EXPECT_EQ(schedule_.next(), first);
  EXPECT_EQ(schedule_.triesOf(first), 0);
}

TEST_F(Schedule, ClosedPointsAndRunsThatWereGivenUpAreNotPlayed) {
  schedule_.closePoint(4);
  schedule_.giveUp(2);
  const std::vector<std::size_t> order = orderOf(schedule_, rows_);
  EXPECT_EQ(order.size(), 17U);
  for (const std::size_t gone : {4U, 14U, 2U}) {
    EXPECT_THAT(order, testing::Not(testing::Contains(gone)));
  }
}

}  // namespace
}  // namespace lab::runner::campaign
