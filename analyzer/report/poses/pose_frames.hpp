/// From the rows of a file of poses to its frames. Internal to pose_file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"

namespace lab::report {

/// A pose, and where it stands.
struct PoseRow {
  std::int64_t line = 0;
  std::int64_t frame = 0;
  double time = 0;  ///< [s]
  analysis::FramePose pose;
};

/// What messages call the file, its columns, and the way out where times are none.
struct PoseNames {
  std::string file;
  std::string id;
  std::string time;
  std::string time_hint;
};

/// Sorts the rows, takes out robots that come twice in a frame and frames whose time does not go
/// on, counts both, and measures the period, the gaps and the steps of the clock.
/// @throws ReportError where too many rows contradict each other or frames have bad times
void collectFrames(std::vector<PoseRow> rows, const PoseNames& names, PoseFile& file);

}  // namespace lab::report
