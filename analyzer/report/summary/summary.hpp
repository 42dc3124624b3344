/// summary.json: its keys are listed in docs/report.md.
#pragma once

#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The complete file. Units are cm and degrees, and part of the keys; numbers have six digits; null
/// if not determined. The content does not depend on time, host or name of the log.
[[nodiscard]] std::string summaryJson(const RunRecord& record);

}  // namespace lab::report
