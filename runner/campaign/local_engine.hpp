/// Runs rows of a campaign in processes of this machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// How an engine ended.
struct EngineEnd {
  bool interrupted = false;  ///< by the user
  bool disk_full = false;
  std::string note{};         ///< why it ended before all rows were tried; empty: it did not
  bool written_only = false;  ///< the jobs were written, for others to run
  bool known = false;         ///< the points are known as well as was asked
};

struct LocalOptions {
  std::size_t jobs = 1;                     ///< runs at a time
  std::int64_t disk_reserve = 100'000'000;  ///< [bytes] no run begins when less is free
  /// Called after each run that ended, and a few times a second.
  std::function<void()> watch{};
};

/// Runs the rows, and keeps `data.survey` up to date. A run that another process kills (no memory)
/// is tried once more; a second time, it has failed. Rows that have a result by now, from another
/// process, are left out.
[[nodiscard]] EngineEnd runLocally(CampaignData& data, const std::filesystem::path& folder,
                                   const std::vector<std::size_t>& rows,
                                   const LocalOptions& options);

/// Lets Ctrl-C and SIGTERM end the engines cleanly.
void catchSignals();
[[nodiscard]] bool wasInterrupted();

}  // namespace lab::runner::campaign
