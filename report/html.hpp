/// report.html: one self-contained page.
#pragma once

#include <string>
#include <vector>

#include "report/figures.hpp"
#include "report/run_record.hpp"

namespace lab::report {

/// The whole page, figures and style inside, without scripts and without references to anything
/// outside. Everything that comes from the log is escaped.
[[nodiscard]] std::string reportHtml(const RunRecord& record, const std::vector<Figure>& figures);

}  // namespace lab::report
