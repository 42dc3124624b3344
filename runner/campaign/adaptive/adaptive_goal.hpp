/// The goal of an adaptive campaign in the numbers of its points. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "runner/campaign/adaptive/goal_state.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// A goal with its candidates: the points of the campaign.
struct CampaignGoal {
  AdaptivePlan plan;
  std::vector<std::size_t> axes;  ///< of the campaign, of each key
  std::vector<Candidate> candidates;
  std::vector<double> costs;  ///< [s] robot time of a run at each candidate
  LawParameter parameter = LawParameter::kExponents;
  std::size_t key = 0;  ///< of kOneExponent

  [[nodiscard]] GoalState state(const std::vector<RunValue>& runs) const;

  /// The design of a mean, for the start.
  [[nodiscard]] GaussianDesign spread(const std::vector<RunValue>& runs) const;
};

/// @throws UserError, in one line, for a plan that cannot be carried out at these points
[[nodiscard]] CampaignGoal goalOf(const Request& request, const std::vector<Point>& points);

/// The estimates so far. Runs without a number are left out.
/// @throws UserError if the runs have no such estimate, or several
[[nodiscard]] std::vector<RunValue> valuesOf(const CampaignData& data);

}  // namespace lab::runner::campaign
