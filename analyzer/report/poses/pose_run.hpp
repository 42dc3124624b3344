/// The physics from poses alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// What the robots of a recording were programmed to do, all of them, all the time.
struct PoseProgram {
  std::string model;  ///< "abp", "noisy_abp", "bp", "rtp" as in experiment files; empty: unknown
  std::vector<std::string> set;  ///< key=value: of the program (v_cm_s=5), or of an experiment file
                                 ///< (robot.diameter_cm=8)
};

/// A run as its poses tell it. There is no light, and no robot says what it does:
/// - contacts are seen by distance: robots nearer than their diameter, and where the arena is
/// known,
///   walls nearer than their radius, cut the track as reported ones do;
/// - headings off by pi are mended, and reversals found by their straight even motion and taken out
///   (docs/stitching.md); without a program there is no telling, and they are part of the motion;
/// - a step of the clock cuts;
/// - of RTP the tumbles are found in the poses (docs/runs.md); where that fails, the speed is taken
///   with the programmed share of run time, and the tumble rate is left open.
/// Without a program there are curves and a speed, and nothing to compare them with.
/// @param name of the run, for its title
/// @throws ExperimentError where the program is not a valid one, ReportError where there are fewer
/// than two frames.
[[nodiscard]] RunRecord poseRun(const PoseFile& poses, const std::string& name,
                                const PoseProgram& program, const ReadOptions& options = {});

}  // namespace lab::report
