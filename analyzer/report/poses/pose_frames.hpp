/// Converts the rows of a file of poses to frames. Internal to pose_file.
#pragma once

#include <cstdint>
#include <string>

#include "analyzer/report/poses/pose_file.hpp"

namespace lab::report {

/// A pose with its line in the file.
struct PoseRow {
  std::int64_t line = 0;
  std::int64_t frame = 0;
  double time = 0;  ///< [s]
  Pose pose;
};

/// Names of the file and its columns for messages, and the remedy for wrong times.
struct PoseNames {
  std::string file;
  std::string id;
  std::string time;
  std::string time_hint;
};

/// Sorts the rows; omits and counts duplicate robots and frames whose time does not increase;
/// determines the period, the gaps and the steps of the clock. @throws ReportError if too many rows
/// contradict each other or have bad times
void collectFrames(DiskVector<PoseRow> rows, const PoseNames& names, PoseFile& file);

}  // namespace lab::report
