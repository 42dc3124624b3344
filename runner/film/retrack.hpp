/// Tracks the films of a run again, with the telemetry in its log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/experiment/experiment.hpp"
#include "light/optics/grey_image.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

struct RetrackOptions {
  std::filesystem::path run;            ///< its folder
  std::filesystem::path calibration{};  ///< of the only camera; empty: that of the run
  std::vector<std::string> set{};       ///< key=value: of its experiment
};

/// The experiment of the run, for a tracker that gets its frames from the films.
/// @throws ExperimentError
[[nodiscard]] Experiment experimentToTrack(const RetrackOptions& options);

/// One frame of the film, as it is tracked now; or one round of frames of several cameras.
struct RetrackedFrame {
  double time = 0;           ///< [s] since the first frame of the films
  std::int64_t frames = 0;   ///< tracked so far, of all cameras
  optics::GreyView picture;  ///< empty: there are several
  const tracked_frame_t& poses;
  const tracked_details_t& details;
};

struct RetrackCounts {
  std::int64_t films = 0;  ///< parts: one for each start of the tracker
  std::int64_t cameras = 1;
  std::int64_t frames = 0;    ///< of the films that were tracked
  std::int64_t poses = 0;     ///< in them
  std::int64_t compared = 0;  ///< frames, or rounds of several cameras, that the log has too
  std::int64_t equal = 0;     ///< of these, with the same TRACKED_FRAME, bit by bit
  std::int64_t missing = 0;   ///< TRACKED_FRAME of the log that the film lacks
  bool lossless = true;
  std::string lacking;  ///< as FilmPass
  std::string problem;  ///< why frames could not be read; empty: all were
};

/// Whether it is the folder of a run, as opposed to a folder of pictures.
[[nodiscard]] bool isRunFolder(const std::filesystem::path& folder);

/// The name of one of several cameras that filmed a run; empty: there was one camera, or no film.
/// @throws ExperimentError if the facts of a film cannot be read
[[nodiscard]] std::string filmedCamera(const std::filesystem::path& run);

/// @throws UserError if the run has no film, or films of several cameras and one calibration is
///   given
void requireFilm(const RetrackOptions& options);

/// Each start of the tracker has its film, and is tracked by a tracker of its own, which gets the
/// frames of all cameras and the ROBOT_STATUS in the order of the run. With the same settings, a
/// lossless film and a log without losses, it publishes the same poses of the same robots, bit by
/// bit.
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
