/// Runs and tumbles as people and programs read them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report {

/// The block "runs" of summary.json. @param whole with histograms and tests, which the pool has.
[[nodiscard]] nlohmann::ordered_json runsJson(const analysis::RunStatistics& runs, bool whole);

/// The distribution of run times on a logarithmic axis, and the histogram of tumble angles.
[[nodiscard]] FigureScript runTimesFigure(const Finding& finding);
[[nodiscard]] FigureScript turnsFigure(const Finding& finding);

namespace html {
/// The section of report.html; empty where no run-and-tumble motion was looked at.
/// @param max_wheel_speed of the robots, m/s.
[[nodiscard]] std::string runs(const std::vector<Finding>& findings, double max_wheel_speed);
}  // namespace html

}  // namespace lab::report
