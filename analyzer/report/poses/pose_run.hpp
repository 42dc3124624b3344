/// Makes a run record from poses alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// The program of all robots, for the whole recording.
struct PoseProgram {
  std::string model;             ///< name of a shipped program; empty: unknown
  std::vector<std::string> set;  ///< key=value: of the program (v_cm_s=5), or of an experiment file
                                 ///< (robot.diameter_cm=8)
};

/// Analyzes poses without light and robot status:
/// - contacts are determined by distance: robots closer than their diameter and, if the arena is
/// known, walls closer than their radius cut the track like reported contacts;
/// - headings that are wrong by pi are corrected, and reversals are found by their straight uniform
/// motion and removed (docs/stitching.md); without a program they cannot be distinguished and
/// remain part of the motion;
/// - a step of the clock cuts;
/// - tumbles between runs are found in the poses (docs/runs.md); if that fails, the speed uses the
/// programmed share of run time, and the tumble rate is not estimated. Without a program, there are
/// curves and a speed, without a comparison.
/// @param name of the run, for its title
/// @throws ExperimentError if the program is invalid, ReportError if there are fewer than two
/// frames.
[[nodiscard]] RunRecord poseRun(PoseFile poses, const std::string& name, const PoseProgram& program,
                                const ReadOptions& options = {});

}  // namespace lab::report
