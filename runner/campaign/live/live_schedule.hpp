/// Which run of a live campaign comes next, and with which robots. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "runner/campaign/campaign.hpp"
#include "runner/campaign/live/live_journal.hpp"
#include "runner/campaign/live/live_plan.hpp"

namespace lab::runner::campaign {

/// The order of the runs, their repetitions, and the robots that are left out.
///
/// The first runs of all points come first, in random order, then the second ones. A drift of
/// the robots during the night (batteries, temperature) therefore does not look like an effect of
/// the swept parameter. A marked run is repeated after the other runs of its turn.
class LiveSchedule {
 public:
  /// @param rows of the campaign
  /// @param open numbers of the rows without a result
  LiveSchedule(const LivePlan& plan, const std::vector<Row>& rows,
               const std::vector<std::size_t>& open, std::uint64_t seed);

  /// Takes what was played, now or before a restart.
  void take(const JournalEntry& entry);

  /// The row that is played next; nothing if all have ended.
  [[nodiscard]] std::optional<std::size_t> next() const;

  /// Leaves out the runs of a point that are still open.
  void closePoint(std::size_t point);

  /// Ends the repetitions of a run.
  void giveUp(std::size_t row);

  /// How often a run was played to its end, or could not be played.
  [[nodiscard]] std::int64_t triesOf(std::size_t row) const;

  /// Robots that had problems in several runs in a row, with the last problem.
  [[nodiscard]] const std::map<std::int32_t, std::string>& leftOut() const { return left_out_; }

 private:
  const LivePlan& plan_;
  const std::vector<Row>& rows_;
  std::vector<std::size_t> queue_;                ///< in the order of the runs
  std::map<std::string, std::int64_t> tries_;     ///< by identity
  std::map<std::int32_t, std::int64_t> strikes_;  ///< by robot: runs in a row with a problem
  std::map<std::int32_t, std::string> left_out_;
};

}  // namespace lab::runner::campaign
