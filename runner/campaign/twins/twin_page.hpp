/// The page of a run among its twins.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/gnuplot_figures.hpp"
#include "runner/campaign/twins/twin_comparison.hpp"

namespace lab::runner::campaign {

struct TwinReport {
  std::string run;      ///< name of the run
  std::string version;  ///< of this software
  TwinComparison comparison;
  std::vector<std::string> remarks;  ///< what the twins do not repeat
};

/// Below this probability of all looks together, a run deviates from its twins.
inline constexpr double kDeviates = 0.01;

/// One or two sentences: whether the run agrees with its twins.
[[nodiscard]] std::string verdictOf(const TwinReport& report);

/// A curve of a program over the band of its twins, each relative to their mean.
/// @param key "msd" or "angular_msd"
/// @return empty script: the curve is not there
[[nodiscard]] report::ScriptedFigure twinCurve(const std::string& run,
                                               const std::vector<std::string>& twins,
                                               std::size_t program, const std::string& key);

/// Names of the programs of a summary.json.
[[nodiscard]] std::vector<std::string> programsOfSummary(const std::string& summary_json);

[[nodiscard]] std::string twinJson(const TwinReport& report);
[[nodiscard]] std::string twinHtml(const TwinReport& report,
                                   const std::vector<report::DrawnFigure>& figures);

}  // namespace lab::runner::campaign
