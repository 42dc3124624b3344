/// trajectories.csv: docs/report.md says what its columns mean.
#pragma once

#include <string>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The whole file: frame,particle,x,y,t,theta,program,segment with x and y in cm, t in s since the
/// start of the run and theta in rad, one row for each robot in each frame. The columns that
/// trackpy reads come first.
[[nodiscard]] std::string trajectoriesCsv(const RunRecord& record);

/// A field of a CSV file, quoted where it must be (RFC 4180).
[[nodiscard]] std::string csvField(const std::string& text);

}  // namespace lab::report
