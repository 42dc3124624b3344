/// Trajectories small enough to draw.
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

/// What is drawn of a run.
struct PlotTracks {
  std::vector<PlotLine> lines;  ///< in order of time for each robot
  double begin = 0;             ///< [s] first and last time that is drawn
  double end = 0;
  bool whole_run = true;  ///< nothing is left out but points between points
};

/// The latest stretch of the run that can be drawn with about `points` points close enough together
/// to follow a robot's path: the whole run where it fits.
/// @param per_program the latest stretch of each program instead, for which the points are shared.
[[nodiscard]] PlotTracks thinnedTracks(const RunRecord& record, std::size_t points,
                                       bool per_program);

}  // namespace lab::report
