/// trajectories.csv: its columns are documented in docs/report.md.
#pragma once

#include <ostream>
#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// Writes the whole file, one row per robot and frame, with x and y in cm, t in s since the start
/// of the run and theta in rad. The columns that trackpy reads come first.
void writeTrajectories(const RunRecord& record, std::ostream& out);

/// A text as a field of a CSV file, quoted if necessary (RFC 4180). Names come from logs: one that
/// a spreadsheet would take for a formula gets a ' before it.
[[nodiscard]] std::string csvField(const std::string& content);

}  // namespace lab::report
