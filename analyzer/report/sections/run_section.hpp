/// Runs and tumbles, as JSON for programs and as HTML for readers.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analyzer/report/summary/findings.hpp"

namespace lab::report {

/// The block "runs" of summary.json.
/// @param whole adds the histograms and the tests, which only the pool of all robots has.
[[nodiscard]] nlohmann::ordered_json runsJson(const analysis::RunStatistics& runs, bool whole);

namespace html {

/// The section of report.html; empty if no program with runs ran.
/// @param max_wheel_speed of the robots [m/s]
[[nodiscard]] std::string runs(const std::vector<Finding>& findings, double max_wheel_speed);

}  // namespace html
}  // namespace lab::report
