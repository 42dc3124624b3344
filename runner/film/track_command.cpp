#include <fmt/format.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/progress_bar.hpp"
#include "runner/film/film_commands.hpp"
#include "runner/film/film_markers.hpp"
#include "runner/film/film_overlay.hpp"
#include "runner/film/film_verdict.hpp"
#include "runner/film/named_files.hpp"
#include "runner/film/pose_writer.hpp"
#include "runner/film/retrack.hpp"
#include "tracker_svc/film_reader.hpp"
#include "tracker_svc/film_tracking.hpp"
#include "tracker_svc/marker_tracking.hpp"
#include "tracker_svc/response_finder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using tracker::FilmRow;

volatile std::sig_atomic_t tracking_interrupted = 0;

/// While it exists, SIGINT, SIGTERM and SIGHUP end the reading of the film, not the program.
class InterruptHandler {
 public:
  InterruptHandler() {
    tracking_interrupted = 0;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      previous_[i] = std::signal(kSignals[i], [](int) { tracking_interrupted = 1; });
    }
  }
  ~InterruptHandler() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) std::signal(kSignals[i], previous_[i]);
  }
  InterruptHandler(const InterruptHandler&) = delete;
  InterruptHandler& operator=(const InterruptHandler&) = delete;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<void (*)(int), kSignals.size()> previous_{};
};

void requireOptions(const TrackOptions& options) {
  if (options.out.empty()) {
    throw UserError(fmt::format("{}: found no --out, which only a run with a film does not need",
                                options.source));
  }
  if (options.calibration.empty() && !(options.cm_per_px > 0)) {
    throw UserError(fmt::format(
        "{}: found no --calibration, which only a run with a film does not need, expected the "
        "calibration of the camera (lab calibrate camera); for blobs and tags below a camera "
        "straight above, --cm-per-px SIZE_OF_A_PIXEL",
        options.source));
  }
  if (!options.set.empty()) {
    throw UserError(
        fmt::format("{}: found --set, which is for the experiment of a run", options.source));
  }
}

/// Refuses outputs that would overwrite the film, the calibration or each other. Single pictures in
/// a folder are not checked.
void refuseSameFiles(const TrackOptions& options) {
  const std::array<std::pair<const char*, fs::path>, 4> named{
      {{"SOURCE", options.source},
       {"--calibration", options.calibration},
       {"--out", options.out},
       {"--overlay", options.overlay}}};
  const auto canonical = [](const fs::path& path) {
    std::error_code error;
    return fs::weakly_canonical(fs::absolute(path, error), error);
  };
  for (std::size_t written = 2; written < named.size(); ++written) {
    const auto& [option, path] = named[written];
    if (path.empty()) continue;
    for (std::size_t other = 0; other < written; ++other) {
      if (named[other].second.empty() || canonical(path) != canonical(named[other].second))
        continue;
      throw UserError(fmt::format("{}: is named as {} and as {}; choose another name for {}",
                                  path.string(), named[other].first, option, option));
    }
  }
}

/// A sheet in the folder of the pictures would be read as a picture in the next run.
void refuseSheetAmongPictures(const TrackOptions& options) {
  std::error_code error;
  if (options.overlay.extension() != ".png" || !fs::is_directory(options.source, error)) return;
  const fs::path folder = fs::absolute(options.overlay, error).parent_path();
  if (!fs::equivalent(folder, options.source, error)) return;
  throw UserError(fmt::format(
      "{}: would be read as one of the pictures of {} in the next run; choose another folder for "
      "--overlay",
      options.overlay.string(), options.source));
}

/// A calibration is valid only for pictures of the size it was made with.
void checkSize(const TrackOptions& options, const CameraCalibration& calibration,
               const FilmReader& reader, int width, int height) {
  const optics::CameraParameters& camera = calibration.camera;
  if (width == camera.width && height == camera.height) return;
  // Enlarging is not suggested: it gives blur and noise that no camera has.
  const bool can_shrink = width > camera.width && width * camera.height == height * camera.width;
  const std::string mark = reader.mark();
  throw UserError(fmt::format(
      "{}: found pictures of {} x {} px{}, expected {} x {} px as in {}; calibrate the camera at "
      "the size of the film{}",
      options.source, width, height,
      mark.empty() ? "" : fmt::format(" (as stored; players rotate them, by {})", mark),
      camera.width, camera.height, options.calibration.string(),
      can_shrink ? fmt::format(", or convert the film: ffmpeg -i FILM -vf scale={}:{} ...",
                               camera.width, camera.height)
                 : ""));
}

tracker::TrackerSettings trackerSettings(const CameraCalibration& calibration) {
  tracker::TrackerSettings settings;
  settings.arena_width = calibration.arena_width;
  settings.arena_height = calibration.arena_height;
  settings.robot_radius = calibration.cap.robot_radius;
  settings.caps_may_be_replaced = true;
  return settings;
}

std::unique_ptr<FilmOverlay> openOverlay(const TrackOptions& options,
                                         const CameraCalibration& calibration,
                                         const detector::MarkerSettings& markers, double fps) {
  if (options.overlay.empty()) return nullptr;
  return FilmOverlay::open(
      {.path = options.overlay,
       .force = options.force,
       .fps = (fps > 0 ? fps : kAssumedFps) / static_cast<double>(options.every),
       .camera = optics::CameraModel(calibration.camera),
       .cap = markers.outline(calibration.cap)});
}

/// Tracks one film from its first frame to its last.
class Film {
 public:
  Film(const TrackOptions& options, const CameraCalibration& calibration,
       const detector::MarkerSettings& markers, FilmReader& reader)
      : options_(options),
        calibration_(calibration),
        markers_(markers),
        reader_(reader),
        detector_(makeMarkerDetector(markers, optics::CameraModel(calibration.camera),
                                     calibration.cap,
                                     calibration.imaging.value_or(optics::Imaging{}))),
        response_(detector_->camera(), calibration.cap,
                  calibration.imaging.value_or(optics::Imaging{})),
        finds_response_(markers.kind == detector::MarkerKind::kCaps &&
                        (!calibration.imaging || !calibration.imaging->gamma)),
        tracker_(makeMarkerTracker(markers, trackerSettings(calibration), {},
                                   options.max_speed_cm_s / units::kCm)),
        tracking_(*detector_, *tracker_, options.robots),
        verdict_(calibration),
        poses_(options.out, markers.kind, options.force),
        overlay_(openOverlay(options, calibration, markers, reader.format().fps)) {}

  ExitCode track() {
    detector_->setCompressed(reader_.format().compressed);
    response_.setCompressed(reader_.format().compressed);
    const InterruptHandler interrupt_handler;
    std::string problem;
    double seconds = 0;
    {
      ProgressBar progress(reader_.length());
      try {
        CameraFrame frame;
        for (std::int64_t i = 0; tracking_interrupted == 0 && reader_.next(frame); ++i) {
          if (i % options_.every == 0) take(frame);
          progress.show(i + 1);
        }
        problem = tracking_interrupted != 0 ? "interrupted before its end" : reader_.problem();
      } catch (const CameraError& error) {
        problem = error.what();
      }
      seconds = progress.seconds();
    }
    if (tracking_.summary().frames == 0) {
      throw UserError(fmt::format("{}: found no frame in it{}{}; expected a movie or pictures",
                                  options_.source, problem.empty() ? "" : ": ", problem));
    }
    poses_.finish();
    draw([&] { overlay_->finish(); });
    printFilmSummary(tracking_.summary(), calibration_, markers_, reader_.dropped(), seconds);
    verdict_.print(tracking_.summary());
    if (!(reader_.format().fps > 0) && tracking_.summary().frames > 1) {
      fmt::print(
          "note     the pictures have no times; {:.0f} pictures per second are assumed: set "
          "--fps, or put frames.csv beside them (docs/cameras.md)\n",
          kAssumedFps);
    }
    if (options_.fps > 0) {
      fmt::print(
          "note     times are those of {:g} frames per second, as given on the command line\n",
          options_.fps);
    }
    if (const std::string mark = reader_.mark(); !mark.empty()) {
      fmt::print(
          "note     players rotate these pictures ({}), here they are used as stored; the "
          "calibration must be made with such pictures (docs/cameras.md)\n",
          mark);
    }
    if (finds_response_) {
      printResponse();
    } else if (tracking_.summary().rows == 0 && calibration_.imaging &&
               calibration_.imaging->gamma) {
      fmt::print("note     grey steps were read with a gamma of {:g}, as the calibration says\n",
                 *calibration_.imaging->gamma);
    }
    fmt::print("poses    {}\n", printable(options_.out.string()));
    if (overlay_) fmt::print("overlay  {}\n", printable(options_.overlay.string()));
    if (!overlay_problem_.empty()) {
      fmt::print("fault    {}: no overlay was written: {}\n", printable(options_.overlay.string()),
                 printable(overlay_problem_));
    }
    if (!problem.empty()) {
      const bool named = problem.starts_with(options_.source);
      fmt::print("fault    {}{}; the poses of what could be read are kept\n",
                 named ? "" : printable(options_.source) + ": ", printable(problem));
    }
    return problem.empty() && overlay_problem_.empty() ? kDone : kClosedEarly;
  }

 private:
  /// Estimates the gamma of the grey values if the calibration does not contain it.
  void findResponse(const CameraFrame& frame) {
    if (!finds_response_) return;
    response_.examine(frame.grey);
    const double gamma = response_.gamma().value_or(gamma_);
    if (gamma != gamma_ && tracking_.summary().frames > 0) gamma_from_ = frame.number;
    gamma_ = gamma;
    detector_->setGamma(gamma);
  }

  void printResponse() const {
    const bool unknown = !response_.gamma() && tracking_.summary().rows > 0;
    if (gamma_ != 1 || unknown || gamma_from_) {
      fmt::print("note     grey steps were read {}: {}\n",
                 gamma_ == 1 ? "as linear in light"
                             : fmt::format("with a gamma of {:g}, as for display encoding", gamma_),
                 response_.reason());
    }
    if (gamma_from_) {
      fmt::print(
          "note     only from frame {} on; earlier frames were read with another gamma. With "
          "gamma in the calibration (docs/cameras.md) all frames are read alike\n",
          *gamma_from_);
    }
  }

  void take(const CameraFrame& frame) {
    constexpr double kMicro = 1e-6;
    checkSize(options_, calibration_, reader_, frame.grey.width, frame.grey.height);
    findResponse(frame);
    const double time = static_cast<double>(frame.utime) * kMicro;
    const bool drawn = overlay_ && overlay_->wantsNext();
    rejected_.clear();
    const std::vector<FilmRow>& rows =
        tracking_.process(frame.number, time, frame.grey, drawn ? &rejected_ : nullptr);
    poses_.write(rows);
    for (const FilmRow& row : rows) verdict_.add(row);
    draw([&] { overlay_->add({frame.number, time, frame.grey, rows, rejected_}); });
  }

  /// Runs `act` on the overlay; if that fails, tracking goes on without an overlay.
  void draw(const auto& act) {
    if (!overlay_) return;
    try {
      act();
    } catch (const std::runtime_error& error) {
      overlay_problem_ = error.what();
      overlay_.reset();
    }
  }

  const TrackOptions& options_;
  const CameraCalibration& calibration_;
  const detector::MarkerSettings& markers_;
  FilmReader& reader_;
  std::unique_ptr<detector::MarkerDetector> detector_;
  detector::ResponseFinder response_;
  bool finds_response_;
  double gamma_ = 1;                        ///< gamma in use
  std::optional<std::int64_t> gamma_from_;  ///< first frame that was read with gamma_; nothing: all
  std::unique_ptr<tracker::MarkerTracker> tracker_;
  tracker::FilmTracking tracking_;
  CalibrationVerdict verdict_;
  PoseWriter poses_;
  std::unique_ptr<FilmOverlay> overlay_;
  std::string overlay_problem_;  ///< why the overlay could not be written
  std::vector<detector::Rejection> rejected_;
};

}  // namespace

ExitCode track(const TrackOptions& options) {
  if (isRunFolder(options.source)) return trackRun(options);
  requireOptions(options);
  refuseSameFiles(options);
  refuseSheetAmongPictures(options);
  std::optional<CameraCalibration> calibration;
  if (!options.calibration.empty()) calibration = readCameraFile(options.calibration);
  // Wrong options are refused before the film is opened.
  static_cast<void>(markersOf(options, calibration.value_or(CameraCalibration{})));
  const std::unique_ptr<FilmReader> reader = openFilm(options.source, options.fps);
  if (const std::string table = reader->table(); options.fps > 0 && !table.empty()) {
    throw UserError(
        fmt::format("{}: found --fps and the times of {}, expected one of them: leave out --fps",
                    options.source, table));
  }
  const CameraFormat format = reader->format();
  if (!calibration) {
    if (format.width <= 0) {
      throw UserError(fmt::format(
          "{}: found no size of its pictures before they are read, expected one for --cm-per-px; "
          "use --calibration",
          options.source));
    }
    calibration = cameraAbove(format.width, format.height, options.cm_per_px);
  }
  if (format.width > 0) checkSize(options, *calibration, *reader, format.width, format.height);
  const detector::MarkerSettings markers = markersOf(options, *calibration);
  return Film(options, *calibration, markers, *reader).track();
}

}  // namespace lab::runner
