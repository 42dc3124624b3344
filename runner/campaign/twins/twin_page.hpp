/// The page of a run among its twins.
#pragma once

#include <cstddef>
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

/// A look as text, for tables.
struct LookTexts {
  std::string name;  ///< "D_r of PROGRAM (rad²/s)"
  std::string run;
  std::string twins;     ///< "0.75 ± 0.04"
  std::string interval;  ///< "0.67 to 0.83"
  std::string z;
  std::string p;
  std::string p_all;
};
[[nodiscard]] LookTexts textsOf(const PlacedLook& look);

/// The looks that deviate most, first.
[[nodiscard]] std::vector<const PlacedLook*> mostUnusual(const TwinComparison& comparison,
                                                         std::size_t most);

/// A row per look.
[[nodiscard]] std::string twinCsv(const TwinReport& report);

[[nodiscard]] std::string twinJson(const TwinReport& report);

/// The page of a run's report with a section on the twins at its end; an earlier one is replaced.
[[nodiscard]] std::string withTwinSection(const std::string& report_page, const TwinReport& report);

[[nodiscard]] std::string twinHtml(const TwinReport& report,
                                   const std::vector<report::DrawnFigure>& figures);

}  // namespace lab::runner::campaign
