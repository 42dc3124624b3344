/// report.html, a single self-contained page.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The complete page with figures and style, without scripts and external references. Text from the
/// log is escaped.
[[nodiscard]] std::string reportHtml(const RunRecord& record, const std::vector<Figure>& figures);

}  // namespace lab::report
