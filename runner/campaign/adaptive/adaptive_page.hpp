/// The rounds of an adaptive campaign on its page. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "runner/campaign/adaptive/adaptive_rounds.hpp"

namespace lab::runner::campaign {

/// "90 of at most 1800 runs, chosen for the exponents of the power law of D_r_rad2_s".
[[nodiscard]] std::string chosenText(const CampaignData& data);

/// HTML: a row per round with its points and errors; empty without a round.
[[nodiscard]] std::string roundsSection(const CampaignData& data,
                                        const std::vector<AdaptiveRound>& rounds);

}  // namespace lab::runner::campaign
