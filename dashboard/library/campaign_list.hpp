/// Lists campaigns (lab sweep) from the files in their folders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

struct CampaignFacts {
  std::string name;         ///< of the campaign's folder
  std::string updated_utc;  ///< "2026-01-31T12:00:00Z"; empty: nothing was run yet
  std::int64_t total = 0;   ///< runs
  std::int64_t done = 0;
  std::int64_t failed = 0;
  bool running = false;  ///< its process lives on this machine
  bool live = false;     ///< played on the real lab
  std::optional<double> seconds_left;
  bool page = false;  ///< whether there is an index.html
};

/// The campaigns in a folder. Without state, so thread-safe.
class CampaignList {
 public:
  explicit CampaignList(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// All campaigns, the last changed first.
  [[nodiscard]] std::vector<CampaignFacts> campaigns() const;

  /// The response to GET /api/campaigns.
  [[nodiscard]] std::string json() const;

  /// The path of a file of a campaign's page ("index.html", "figures/x.svg"), or of the report of
  /// one of its runs ("runs/ID/report.html"). Nothing if it must not be sent.
  [[nodiscard]] std::optional<std::filesystem::path> file(std::string_view campaign,
                                                          std::string_view name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lab::dashboard
