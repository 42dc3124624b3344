/// The rounds of an adaptive campaign: which runs come next, and why. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runner/campaign/adaptive/goal_state.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// A run that was chosen.
struct PlannedRun {
  std::string recipe;  ///< RunIdentity::recipe: rows may be numbered anew
  std::size_t row = 0;
  std::vector<std::string> values;  ///< of the swept keys
  double robot_time_s = 0;          ///< [s]
  double reduction = 0;  ///< expected, of the variance that is asked for, after the runs before it

  bool operator==(const PlannedRun&) const = default;
};

struct AdaptiveRound {
  std::int64_t number = 1;
  std::vector<PlannedRun> runs;  ///< empty: the campaign has ended
  double robot_time_s = 0;       ///< [s] of the runs before it
  double error = 0;              ///< before it; infinite: not known yet
  double expected_error = 0;     ///< after it
  std::string end;               ///< why there are no runs
};

/// The next round, of the runs that were tried so far. It depends on nothing but the campaign and
/// its results.
/// @throws UserError if the runs have no such estimate
[[nodiscard]] AdaptiveRound nextRound(const CampaignData& data, std::int64_t number);

/// What is known now; the design is that of the next run.
[[nodiscard]] GoalState goalState(const CampaignData& data);

/// "eta_rad_s=3, epsilon_s=0.1 (2 runs); ...": the points of a round, the first ones by name.
[[nodiscard]] std::string placesText(const CampaignData& data, const AdaptiveRound& round);

/// "round    3: eta_rad_s=3, epsilon_s=0.1 (2 runs) ...; error 0.031, 0.027 expected; ..."
[[nodiscard]] std::string roundText(const CampaignData& data, const AdaptiveRound& round);

/// "exponents of the law of D_r_rad2_s"
[[nodiscard]] std::string goalText(const AdaptivePlan& plan);

/// "2.1 %", "0.0034 rad2/s": an error of the goal.
[[nodiscard]] std::string errorText(const AdaptivePlan& plan, double error);

/// A line of adaptive.jsonl, with its end of line.
[[nodiscard]] std::string roundLine(const AdaptiveRound& round);

/// Rounds in their order. Lines that cannot be read are left out.
/// @param axes number of swept keys: a line with another number of values cannot be read
[[nodiscard]] std::vector<AdaptiveRound> readRounds(std::string_view text, std::size_t axes);

/// Rows that were chosen, and have neither result nor failure: the rest of a round that was
/// interrupted.
[[nodiscard]] std::vector<std::size_t> openRows(const CampaignData& data,
                                                const std::vector<AdaptiveRound>& rounds);

/// surface.csv: what is known at each place, by the process or the law.
[[nodiscard]] std::string surfaceCsv(const CampaignData& data, const GoalState& state);

/// boundary.csv: where the quantity crosses the level, for each combination of the other keys.
[[nodiscard]] std::string boundaryCsv(const CampaignData& data, const GoalState& state);

}  // namespace lab::runner::campaign
