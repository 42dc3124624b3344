/// trajectories.csv: docs/report.md says what its columns mean.
#pragma once

#include <string>

#include "report/run_record.hpp"

namespace lab::report {

/// The whole file: frame,particle,x,y,t,theta,program,segment with x and y in cm, t in s since the
/// start of the run and theta in rad, one row for each robot in each frame. The columns that
/// trackpy reads come first.
[[nodiscard]] std::string trajectoriesCsv(const RunRecord& record);

}  // namespace lab::report
