/// Reads CSV files of poses, from `lab track` or another tracker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/files/disk_vector.hpp"

namespace lab::report {

/// Information that the file may lack.
struct PoseFileOptions {
  std::optional<double> scale;  ///< length of one unit of its columns x and y [m]
  std::optional<double> fps;    ///< frame rate [1/s], if the file has no column of times
};

/// A robot in a frame, SI units.
struct Pose {
  int robot = 0;
  bool valid = true;  ///< false: its confidence is low
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// A frame of a recording.
struct PoseFrame {
  double time = 0;  ///< [s]
  std::int64_t frame = 0;
  std::size_t first = 0;  ///< index into PoseFile::poses
};

/// All poses, in order of time, and of the robots in each frame.
struct PoseFile {
  std::vector<PoseFrame> frames;
  DiskVector<Pose> poses;
  bool headings = false;  ///< the file has a column of headings
  bool times = false;     ///< the file has a column of times
  bool in_arena =
      false;  ///< the columns are x_cm and y_cm, with the origin at a corner of the arena
  std::int64_t rows = 0;
  std::int64_t without_pose = 0;    ///< rows omitted: no number for x, y or the heading
  std::int64_t without_id = 0;      ///< rows omitted: id 0, not in a track
  std::int64_t repeated = 0;        ///< rows omitted: repetitions of a pose
  std::int64_t contradicted = 0;    ///< poses omitted: a robot at two positions in one frame
  std::int64_t missing_frames = 0;  ///< gaps in the frame numbers
  std::int64_t bad_times = 0;       ///< frames omitted: their time does not increase
  std::vector<double> clock_steps;  ///< [s] times of frames after a step of the clock
  double frame_period = 0;          ///< [s] median, 0: fewer than two frames

  /// Appends a frame.
  void add(double time, std::int64_t frame, std::span<const Pose> robots) {
    frames.push_back({time, frame, poses.size()});
    for (const Pose& pose : robots) poses.push_back(pose);
  }

  /// The poses of frames[i].
  [[nodiscard]] std::span<Pose> posesOf(std::size_t i) {
    return poses.part(frames[i].first, endOf(i));
  }
  [[nodiscard]] std::span<const Pose> posesOf(std::size_t i) const {
    return poses.part(frames[i].first, endOf(i));
  }

  /// Calls visit(frame, poses) for all frames, in order.
  template <class Visit>
  void eachFrame(Visit&& visit) {
    eachFrameOf(*this, visit);
  }
  template <class Visit>
  void eachFrame(Visit&& visit) const {
    eachFrameOf(*this, visit);
  }

 private:
  [[nodiscard]] std::size_t endOf(std::size_t i) const {
    return i + 1 < frames.size() ? frames[i + 1].first : poses.size();
  }

  template <class Self, class Visit>
  static void eachFrameOf(Self& self, Visit& visit) {
    for (std::size_t i = 0; i < self.frames.size(); ++i) {
      visit(self.frames[i], self.posesOf(i));
      self.poses.keepNear(self.endOf(i));
    }
    self.poses.releaseMemory();
  }
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
/// A number may be nan, inf or empty: then the pose is unknown.
///
/// Bad times: frames whose time does not increase are omitted; more than one in twenty is an error.
/// Steps of the clock against the frame numbers by more than three frames are recorded. A robot
/// twice in a frame: equal poses count once; different ones are both omitted, because it is unknown
/// which one is right, and more than one in twenty is an error.
/// @param name of the file, for messages
/// @throws ReportError: file, line, column, what was found and what was expected.
[[nodiscard]] PoseFile readPoses(std::istream& text, const std::string& name,
                                 const PoseFileOptions& options = {});

/// The files of TRex in a folder, ordered by number; empty if there are none.
[[nodiscard]] std::vector<std::filesystem::path> trexFiles(const std::filesystem::path& folder);

/// The same for a file, or for all files of TRex in a folder. @throws ReportError also if it cannot
/// be read.
[[nodiscard]] PoseFile readPoses(const std::filesystem::path& file,
                                 const PoseFileOptions& options = {});

}  // namespace lab::report
