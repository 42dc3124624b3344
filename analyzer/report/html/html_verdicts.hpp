/// The verdicts of report.html: is the measured motion the programmed one?
#pragma once

#include <string>
#include <vector>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/report/summary/findings.hpp"

namespace lab::report::html {

/// "agrees", "deviates", "undecided": the word for readers, and the class in the style sheet.
[[nodiscard]] const char* verdictClass(analysis::VerdictKind kind);

/// The same for a result: "partly" for an agreement that needs a reserve.
[[nodiscard]] const char* verdictClass(const analysis::ProgramResult& result);

/// One row per program: its verdict, the largest deviation and the estimate that characterises it.
[[nodiscard]] std::string verdictTable(const std::vector<Finding>& findings);

/// One card per program: reasons, caveats, all estimates, the fit, and the results of each robot.
/// Empty without findings.
[[nodiscard]] std::string programCards(const std::vector<Finding>& findings);

/// One row per estimate: measured value, 95 % interval, programmed value, estimator.
[[nodiscard]] std::string estimateTable(const std::vector<analysis::Estimate>& estimates);

}  // namespace lab::report::html
