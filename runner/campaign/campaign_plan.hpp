/// From a request to the points of a campaign: every point's experiment is made and checked before
/// anything runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/campaign/campaign.hpp"
#include "runner/campaign/campaign_folder.hpp"

namespace lab::runner::campaign {

struct Plan {
  std::vector<Point> points;
  CampaignFiles files;
};

/// @param text of the experiment file `request.file`, which paths are relative to
/// @throws ExperimentError, UserError for a point that cannot run: in virtual time, or on the lab
[[nodiscard]] Plan planCampaign(const Request& request, const std::string& text);

/// The experiment of a run.
/// @param folder of the campaign
[[nodiscard]] Experiment experimentOf(const Point& point, std::uint64_t seed,
                                      const std::filesystem::path& folder);

/// What a campaign costs, as far as it is known before it begins.
struct Cost {
  double virtual_s = 0;         ///< [s] of all runs
  std::int64_t kept_bytes = 0;  ///< by all runs
  std::int64_t work_bytes = 0;  ///< by one run in flight, at most
};

/// @param rows of the campaign, of which the cost is asked
[[nodiscard]] Cost costOf(const Request& request, const std::vector<Point>& points,
                          const std::vector<Row>& rows);

}  // namespace lab::runner::campaign
