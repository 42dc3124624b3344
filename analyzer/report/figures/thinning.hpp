/// Selects points of trajectories to draw.
#pragma once

#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

struct PlotPoint {
  double t = 0;  ///< [s] since the start
  double x = 0;  ///< [cm]
  double y = 0;  ///< [cm]
};

/// An uninterrupted piece of one robot's track.
struct PlotLine {
  int robot = 0;
  int program = -1;   ///< key
  bool free = false;  ///< false: reversing, in contact or standing
  std::vector<PlotPoint> points;
};

/// The part of a run that is drawn.
struct PlotTracks {
  std::vector<PlotLine> lines;  ///< in time order for each robot
  double begin = 0;             ///< [s] first and last drawn time
  double end = 0;
  bool whole_run = true;  ///< only intermediate points are omitted
};

/// The latest part of the run that can be drawn with about `points` points that are dense enough to
/// show the path; the whole run if possible.
/// @param per_program the latest part of each program instead; programs share the points.
[[nodiscard]] PlotTracks thinnedTracks(const RunRecord& record, std::size_t points,
                                       bool per_program);

}  // namespace lab::report
