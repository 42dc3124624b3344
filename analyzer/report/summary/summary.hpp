/// summary.json: docs/report.md lists its keys.
#pragma once

#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The whole file. People's units, named in the keys; numbers rounded to six figures; null for what
/// was not determined. Nothing in it depends on when, where or under which name the log is read.
[[nodiscard]] std::string summaryJson(const RunRecord& record);

}  // namespace lab::report
