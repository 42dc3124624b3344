/// A stored campaign as the data of its tables, for this version of the code.
#pragma once

#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// What of this program decides the bytes of a run.
[[nodiscard]] CodeVersion thisCode();

/// The campaign without its results.
[[nodiscard]] CampaignData dataOf(StoredCampaign campaign);

}  // namespace lab::runner::campaign
