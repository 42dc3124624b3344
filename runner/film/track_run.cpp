#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/camera/run_film.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/command_line/progress_bar.hpp"
#include "runner/film/film_commands.hpp"
#include "runner/film/film_overlay.hpp"
#include "runner/film/pose_writer.hpp"
#include "runner/film/retrack.hpp"
#include "runner/runs/run_directory.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

void refuseFilmOptions(const TrackOptions& options) {
  const char* refused = options.every != 1   ? "--every"
                        : options.fps > 0    ? "--fps"
                        : options.robots > 0 ? "--robots"
                                             : nullptr;
  if (refused == nullptr) return;
  throw UserError(fmt::format(
      "{}: found {}, which is for other films: a run is tracked as it was, every frame with its "
      "own time; to track its movie alone, give {}/film/film.mkv",
      options.source, refused, options.source));
}

/// Marks are drawn with the calibration of one camera.
void refuseOverlay(const TrackOptions& options) {
  const std::string camera = options.overlay.empty() ? "" : filmedCamera(options.source);
  if (camera.empty()) return;
  throw UserError(
      fmt::format("{0}: found --overlay and films of several cameras, expected one film: give "
                  "{0}/film/{1}/film.mkv; lab analyze {0} makes a film.mp4 of all",
                  options.source, camera));
}

std::unique_ptr<FilmOverlay> overlayOf(const TrackOptions& options, const fs::path& run) {
  if (options.overlay.empty()) return nullptr;
  const CameraCalibration calibration = readCameraFile(
      options.calibration.empty() ? run / files::kCalibration / "camera_in_force.json"
                                  : options.calibration);
  const FilmFacts facts = readFilmFacts(run / film_files::kFolder / film_files::kFacts);
  return FilmOverlay::open({.path = options.overlay,
                            .force = options.force,
                            .fps = facts.format.fps > 0 ? facts.format.fps : kAssumedFps,
                            .camera = optics::CameraModel(calibration.camera),
                            .cap = calibration.cap});
}

}  // namespace

ExitCode trackRun(const TrackOptions& options) {
  refuseFilmOptions(options);
  const fs::path run = options.source;
  const std::int64_t length = filmFramesOf(run);
  const RetrackOptions again{run, options.calibration, options.set};
  requireFilm(again);  // before any file is made
  refuseOverlay(options);
  if (options.out.empty()) refuseLink(run / film_files::kFolder);
  const fs::path out = options.out.empty() ? run / film_files::kFolder / "poses.csv" : options.out;
  // TRACKED_FRAME has no areas and axes of blobs: the columns are those of caps.
  PoseWriter poses(out, detector::MarkerKind::kCaps, options.force);
  const std::unique_ptr<FilmOverlay> overlay = overlayOf(options, run);
  RetrackCounts counts;
  double seconds = 0;
  {
    ProgressBar progress(length);
    counts = retrack(again, nullptr, [&](const RetrackedFrame& frame) {
      const std::vector<tracker::FilmRow> rows = filmRowsOf(frame.poses, frame.details, frame.time);
      poses.write(rows);
      if (overlay) {
        overlay->add({frame.poses.frame, frame.time, frame.picture, rows, {}});
      }
      progress.show(frame.frames);
    });
    seconds = progress.seconds();
  }
  poses.finish();
  if (overlay) overlay->finish();
  fmt::print("{}, {:.0f} frames/s\n", printable(retrackText(counts)),
             static_cast<double>(counts.frames) / std::max(seconds, 1e-9));
  fmt::print("poses    {}\n", printable(out.string()));
  if (overlay) fmt::print("overlay  {}\n", printable(options.overlay.string()));
  if (!counts.problem.empty()) {
    fmt::print("fault    {}; the poses of what could be read are kept\n",
               printable(counts.problem));
  }
  return counts.problem.empty() ? kDone : kClosedEarly;
}

}  // namespace lab::runner
