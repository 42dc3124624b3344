/// Collective states, as JSON for programs and as HTML for readers.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The block "collective" of summary.json: one entry for all robots and one per program.
[[nodiscard]] nlohmann::ordered_json crowdsJson(const RunRecord& record);

/// Names of the figures of the section.
[[nodiscard]] std::vector<std::string> crowdFigureNames();

namespace html {

/// The section of report.html; empty below four robots.
[[nodiscard]] std::string crowds(const RunRecord& record, const std::vector<Figure>& figures);

}  // namespace html
}  // namespace lab::report
