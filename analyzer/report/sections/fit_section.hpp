/// The fit of the exact law, for summary.json and report.html.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/fits/law_fit.hpp"

namespace lab::report {

/// Each estimate under its name with its unit, in display units (cm, degrees).
[[nodiscard]] nlohmann::ordered_json estimatesJson(
    const std::vector<analysis::Estimate>& estimates);

/// Key "fit" of summary.json: the reason if there is no fit, or parameters, intervals and tests.
[[nodiscard]] nlohmann::ordered_json fitJson(const analysis::LawFit& fit);

/// The table "Fit of the exact law" with its tests.
[[nodiscard]] std::string fitHtml(const analysis::LawFit& fit);

}  // namespace lab::report
