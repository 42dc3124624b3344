/// Trajectories without a lab: a CSV file of poses, of `lab track` or of another tracker.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/service/analysis.hpp"

namespace lab::report {

/// What the file itself may not say.
struct PoseFileOptions {
  std::optional<double> scale;  ///< [m] of one unit of its columns x and y
  std::optional<double> fps;    ///< [1/s] of its frames, where it has no column of times
};

/// Every pose, in order of time.
struct PoseFile {
  std::vector<analysis::Frame>
      frames;             ///< SI units; a pose that its tracker did not trust is invalid
  bool headings = false;  ///< it has a column of headings
  bool times = false;     ///< it has a column of times
  bool in_arena = false;  ///< x_cm and y_cm: the origin is a corner of the arena
  std::int64_t rows = 0;
  std::int64_t without_pose = 0;    ///< rows left out: no number for x, y or the heading
  std::int64_t without_id = 0;      ///< rows left out: id 0, belonging to no track
  std::int64_t repeated = 0;        ///< rows left out: the same pose of the same robot once more
  std::int64_t contradicted = 0;    ///< poses left out: a robot in two places in one frame
  std::int64_t missing_frames = 0;  ///< gaps in the frame numbers
  std::int64_t bad_times = 0;  ///< frames left out: their time repeats an earlier one or goes back
  std::vector<double> clock_steps;  ///< [s] times of frames to which the clock jumped
  double frame_period = 0;          ///< [s] median, 0: fewer than two frames
};

/// Reads poses by the names of their columns, in any order, others ignored; fields are separated by
/// commas, semicolons or tabs:
///   frame                      a whole number
///   id or particle             a whole number
///   x_cm, y_cm; or x, y        the latter in units of options.scale
///   theta_rad or theta         optional [rad]
///   t_s, t or time             [s]; or frame / options.fps
/// or by those of TRex, one file for each individual NAME_fish0.csv or NAME_id0.csv:
///   frame; X#wcentroid, Y#wcentroid (or #centroid, #pcentroid) [cm]; ANGLE optional [rad]; time
///   [s]; missing optional, 1: not seen (the place may be an interpolated one). "X (cm)" is "X".
///   confidence                 optional, 0 to 1; below 0.5 the pose is not used
/// A number may be nan, inf or empty: then nothing is known of that robot in that frame.
///
/// Bad times: frames whose time does not go on are left out, unless they are more than one in
/// twenty, and a step of the clock against the frame numbers by more than three frames is told.
/// A robot that comes twice in a frame: the same pose counts once; of two different ones nobody
/// knows which is right, and both are left out, unless they are more than one in twenty.
/// @param name of the file, for messages
/// @throws ReportError: file, line, column, what was found and what was expected.
[[nodiscard]] PoseFile readPoses(std::istream& text, const std::string& name,
                                 const PoseFileOptions& options = {});

/// The files of TRex in a folder, by number; empty where it holds none.
[[nodiscard]] std::vector<std::filesystem::path> trexFiles(const std::filesystem::path& folder);

/// The same of a file, or of all the files of TRex in a folder. @throws ReportError also where it
/// cannot be read.
[[nodiscard]] PoseFile readPoses(const std::filesystem::path& file,
                                 const PoseFileOptions& options = {});

}  // namespace lab::report
