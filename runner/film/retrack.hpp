/// Tracks the film of a run again, with the telemetry in its log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "light/optics/grey_image.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

struct RetrackOptions {
  std::filesystem::path run;          ///< its folder
  std::filesystem::path calibration;  ///< of the camera; empty: that of the run
  std::vector<std::string> set;       ///< key=value: of its experiment
};

/// One frame of the film, as it is tracked now.
struct RetrackedFrame {
  double time = 0;  ///< [s] since the first frame of the film
  optics::GreyView picture;
  const tracked_frame_t& poses;
  const tracked_details_t& details;
};

struct RetrackCounts {
  std::int64_t films = 0;     ///< parts: one for each start of the tracker
  std::int64_t frames = 0;    ///< of the film that were tracked
  std::int64_t poses = 0;     ///< in them
  std::int64_t compared = 0;  ///< of the frames, those that the log has too
  std::int64_t equal = 0;     ///< of these, with the same TRACKED_FRAME, bit by bit
  std::int64_t missing = 0;   ///< TRACKED_FRAME of the log that the film lacks
  bool lossless = true;
  std::string problem;  ///< why frames could not be read; empty: all were
};

/// Whether it is the folder of a run, as opposed to a folder of pictures.
[[nodiscard]] bool isRunFolder(const std::filesystem::path& folder);

/// @throws UserError if the run has no film
void requireFilm(const std::filesystem::path& run);

/// Each start of the tracker has its film, and is tracked by a tracker of its own, which gets the
/// frames and the ROBOT_STATUS in the order of the run. With the same settings, a lossless film and
/// a log without losses, it publishes the same poses of the same robots, bit by bit.
/// @param log if not null, receives all messages of the run, with the new poses in place of the
///   old; TRACKED_FRAME of frames that the film lacks are left out
/// @param take called with every frame of the film
/// @throws UserError if there is no film, or calibration or settings cannot be used
[[nodiscard]] RetrackCounts retrack(const RetrackOptions& options, LogWriter* log,
                                    const std::function<void(const RetrackedFrame&)>& take);

/// Number of frames of the films of a run, by their facts.
[[nodiscard]] std::int64_t filmFramesOf(const std::filesystem::path& run);

/// The robots of a frame as rows of a file of poses. `id` is the robot; 0: not identified.
[[nodiscard]] std::vector<tracker::FilmRow> filmRowsOf(const tracked_frame_t& poses,
                                                       const tracked_details_t& details,
                                                       double time);

/// "the poses of the run came again, bit by bit, in 600 of 600 frames", and what differs.
[[nodiscard]] std::string retrackText(const RetrackCounts& counts);

}  // namespace lab::runner
