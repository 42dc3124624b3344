/// The page of a campaign.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

struct PageOptions {
  std::vector<std::string> show;  ///< quantities to draw; empty: chosen by their variation
  bool figures = true;
  bool running = false;  ///< the page loads itself again and again
};

/// Writes campaign.csv, points.csv and campaign.json, each completely or not at all.
/// @throws DiskFull
void writeCsv(const CampaignData& data, const std::filesystem::path& folder,
              const PooledTable& pooled);

/// Writes campaign.csv, points.csv, campaign.json, index.html and the figures, each completely or
/// not at all.
/// @return lines for the terminal
/// @throws ReportError, DiskFull
std::vector<std::string> writeTables(const CampaignData& data, const std::filesystem::path& folder,
                                     const PageOptions& options);

}  // namespace lab::runner::campaign
