/// report.html: one self-contained page.
#pragma once

#include <string>
#include <vector>

#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The whole page, figures and style inside, without scripts and without references to anything
/// outside. Everything that comes from the log is escaped.
[[nodiscard]] std::string reportHtml(const RunRecord& record, const std::vector<Figure>& figures);

}  // namespace lab::report
