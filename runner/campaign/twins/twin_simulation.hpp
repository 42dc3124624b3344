/// Simulates the twins of a run as a campaign.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/twin_facts.hpp"
#include "runner/campaign/design.hpp"
#include "runner/campaign/twins/twin_experiment.hpp"

namespace lab::runner::campaign {

/// How runs are analyzed that are compared with twins, and the twins: without fits, which repeat
/// the direct estimates.
inline const report::AnalyzeOptions kTwinAnalysis{.needs_frames = false,
                                                  .depth = analysis::Depth::kLive};

/// A run of which twins are simulated.
struct TwinOrigin {
  std::filesystem::path run;  ///< as given: folder or log
  std::filesystem::path
      log;  ///< absolute folder of the log, to which the experiment's paths are relative
  report::TwinFacts facts;
  TwinExperiment twins;
};

/// @throws UserError, ReportError if the run cannot be used, or its twins would say nothing
[[nodiscard]] TwinOrigin readTwinOrigin(const std::filesystem::path& run);

/// Which twins.
struct TwinPlan {
  std::filesystem::path folder;  ///< of the campaign
  std::int64_t count = 0;        ///< twins of each experiment, or in all if parameters are drawn
  std::vector<std::string> set = {};   ///< KEY=VALUE, for all
  std::vector<std::string> over = {};  ///< KEY=LOW:HIGH, drawn for each
};

/// The summaries of the twins, and why some are missing.
struct TwinSummaries {
  std::vector<std::string> summaries;
  std::vector<PointValues> values;  ///< of each of these: the drawn parameters as text
  std::size_t failed = 0;
  std::string reason;  ///< of the first failure
  bool interrupted = false;
};

/// Plans the twins, writes their campaign, and simulates those that the folder does not have yet.
/// @param jobs twins at a time; 0: one per core
/// @throws UserError, ExperimentError
[[nodiscard]] TwinSummaries simulateTwins(const TwinOrigin& origin, const TwinPlan& plan, int jobs);

}  // namespace lab::runner::campaign
