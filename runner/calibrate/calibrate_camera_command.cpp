#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "light/optics/simulated_camera.hpp"
#include "runner/calibrate/board_finder.hpp"
#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/calibrate/cap_collector.hpp"
#include "runner/calibrate/lab_film.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/command_line/progress_bar.hpp"
#include "runner/film/named_files.hpp"
#include "tracker_svc/calibration/board.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"
#include "tracker_svc/calibration/camera_report.hpp"
#include "tracker_svc/calibration/cap_sheet.hpp"
#include "tracker_svc/film_reader.hpp"
#include "tracker_svc/response_finder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using calibration::CameraFit;
using calibration::CameraObservations;

constexpr double kCenti = 0.01;            // [m]
constexpr std::size_t kFirstPictures = 6;  // pictures for the first estimate of the camera
constexpr std::size_t kFewestBoards = 4;
constexpr std::size_t kMostBoards = 40;
constexpr std::int64_t kMostFrames = 2000;  // frames to search, spread evenly over the film

std::vector<double> numbersIn(const std::string& text, const std::string& separators) {
  std::vector<double> out;
  for (const std::string& part : CLI::detail::split(text, ' ')) {
    std::string rest = part;
    std::ranges::replace_if(
        rest, [&](char c) { return separators.find(c) != std::string::npos; }, ' ');
    for (const std::string& word : CLI::detail::split(rest, ' ')) {
      double value = 0;
      if (word.empty()) continue;
      if (!CLI::detail::lexical_cast(word, value)) return {};
      out.push_back(value);
    }
  }
  return out;
}

optics::CapGeometry capOf(const CalibrateCameraOptions& options) {
  optics::CapGeometry cap;
  cap.robot_radius = kCenti * options.robot_radius_cm;
  cap.cap_radius = kCenti * options.cap_radius_cm;
  cap.height = kCenti * options.cap_height_cm;
  cap.big_radius = kCenti * options.big_radius_cm;
  cap.small_radius = kCenti * options.small_radius_cm;
  cap.big_offset = kCenti * options.big_offset_cm.value_or(options.spacing_cm / 2);
  cap.small_offset = cap.big_offset - kCenti * options.spacing_cm;
  const auto refuse = [](const char* option, double found, const char* expected, double limit) {
    throw UserError(
        fmt::format("{}: found {:g}, expected {} {:.4g}", option, found, expected, limit));
  };
  if (options.small_radius_cm >= options.big_radius_cm) {
    refuse("--small-radius-cm", options.small_radius_cm, "less than the big circle's",
           options.big_radius_cm);
  }
  const double both = options.big_radius_cm + options.small_radius_cm;
  if (options.spacing_cm < both) {
    refuse("--spacing-cm", options.spacing_cm, "at least the sum of both circles' radii,", both);
  }
  const double reach =
      std::max(cap.big_offset + cap.big_radius, cap.small_radius - cap.small_offset);
  if (reach > cap.cap_radius) {
    refuse("--cap-radius-cm", options.cap_radius_cm,
           "at least the reach of the circles from the axis,", reach / kCenti);
  }
  return cap;
}

CameraObservations observationsFor(const CalibrateCameraOptions& options) {
  CameraObservations observations;
  const std::vector<double> corners = numbersIn(options.corners, ",;");
  if (corners.size() != 8) {
    throw UserError(
        fmt::format("--corners: found \"{}\", expected four pixels \"u,v u,v u,v u,v\": the "
                    "arena's inner corners (0, 0), (width, 0), (width, height), (0, height) on the "
                    "floor",
                    options.corners));
  }
  for (std::size_t i = 0; i < 4; ++i)
    observations.corners[i] = {corners[2 * i], corners[2 * i + 1]};
  const std::vector<double> arena = numbersIn(options.arena_cm, "x");
  if (arena.size() != 2 ||
      !(arena[0] >= 10 && arena[0] <= 2000 && arena[1] >= 10 && arena[1] <= 2000)) {
    throw UserError(
        fmt::format("--arena-cm: found \"{}\", expected width x height as 120x90, each 10 to 2000",
                    options.arena_cm));
  }
  observations.arena_width = kCenti * arena[0];
  observations.arena_height = kCenti * arena[1];
  observations.corner_sigma = options.corner_px;
  observations.cap = capOf(options);
  if (options.camera_height_cm) observations.camera_height = kCenti * *options.camera_height_cm;
  observations.with_k3 = options.k3;
  return observations;
}

/// Moves the first corner from (0, 0) to its place in the arena.
void moveOrigin(const CalibrateCameraOptions& options, CameraCalibration& calibration) {
  const std::vector<double> origin = numbersIn(options.origin_cm, ",;");
  const auto allowed = [](double cm) { return cm >= 0 && cm <= 3000; };
  if (origin.size() != 2 || !std::ranges::all_of(origin, allowed)) {
    throw UserError(fmt::format("--origin-cm: found \"{}\", expected x,y as 66,0, each 0 to 3000",
                                options.origin_cm));
  }
  const double x = kCenti * origin[0];
  const double y = kCenti * origin[1];
  calibration.camera = optics::movedCamera(calibration.camera, x, y);
  calibration.arena_width += x;
  calibration.arena_height += y;
}

void checkSize(const std::string& source, const CameraObservations& observations,
               const CameraFrame& frame) {
  if (frame.grey.width == observations.width && frame.grey.height == observations.height) return;
  throw UserError(fmt::format("{}: frame {} has {} x {} px, expected {} x {} as before", source,
                              frame.number, frame.grey.width, frame.grey.height, observations.width,
                              observations.height));
}

/// Pictures spread evenly over a film of unknown length. Sets the picture size in `observations`.
std::vector<optics::GreyImage> firstPictures(const std::string& source,
                                             CameraObservations& observations,
                                             optics::Imaging& imaging) {
  const std::unique_ptr<FilmReader> film = openFilm(source);
  imaging.compressed = film->format().compressed;
  std::vector<optics::GreyImage> pictures;
  std::int64_t every = 1;
  CameraFrame frame;
  for (std::int64_t i = 0; film->next(frame); ++i) {
    const optics::GreyView& grey = frame.grey;
    if (observations.width == 0) {
      observations.width = grey.width;
      observations.height = grey.height;
    }
    checkSize(source, observations, frame);
    if (i % every != 0) continue;
    optics::GreyImage& picture = pictures.emplace_back(grey.width, grey.height);
    for (int y = 0; y < grey.height; ++y) std::copy_n(grey.row(y), grey.width, picture.row(y));
    if (pictures.size() < 2 * kFirstPictures) continue;
    for (std::size_t kept = 0; kept < kFirstPictures; ++kept) {
      if (kept > 0) pictures[kept] = std::move(pictures[2 * kept]);
    }
    pictures.resize(kFirstPictures);
    every *= 2;
  }
  if (pictures.empty()) {
    const std::string problem = film->problem();
    throw UserError(fmt::format("{}: found no frame in it{}{}; expected a movie or pictures",
                                source, problem.empty() ? "" : ": ", problem));
  }
  return pictures;
}

/// Result of a calibration.
struct Calibrated {
  CameraFit fit;
  std::optional<double> blur;   // [px]
  std::optional<double> gamma;  // Imaging::gamma
};

/// Estimates the gamma of the camera from the pictures and sets it in `imaging`.
/// @return the gamma if it is certain enough for the calibration file
std::optional<double> findResponse(const std::vector<optics::GreyImage>& pictures,
                                   const optics::CameraParameters& camera,
                                   const CameraObservations& observations,
                                   optics::Imaging& imaging) {
  detector::ResponseFinder finder(optics::CameraModel(camera), observations.cap, imaging);
  for (const optics::GreyImage& picture : pictures) finder.examine(picture.view());
  if (finder.gamma()) imaging.gamma = finder.gamma();
  fmt::print(
      "response  gamma {:g}: {}{}\n", imaging.gamma.value_or(1), finder.reason(),
      finder.isSettled() ? "" : "; too little light or too few caps to be certain, not written");
  return finder.isSettled() ? imaging.gamma : std::nullopt;
}

/// First estimate of the camera, with the gamma (1 or video) with which most caps are found.
std::optional<optics::CameraParameters> roughCameraOf(
    const CameraObservations& observations, const std::vector<optics::GreyImage>& pictures,
    optics::Imaging& imaging) {
  RoughCamera best;
  optics::Imaging candidate = imaging;
  for (const double gamma : {1.0, optics::kVideoGamma}) {
    candidate.gamma = gamma;
    const RoughCamera found = roughCamera(observations, pictures, candidate);
    if (found.caps <= best.caps) continue;
    best = found;
    imaging.gamma = gamma;
  }
  if (best.caps == 0) return std::nullopt;
  return best.camera;
}

/// Finds the caps of the whole film with this camera, and this blur if it is known, and stores them
/// in `observations`.
/// @return the blur of the caps [px]
std::optional<double> findCaps(const std::string& source, const optics::CameraParameters& camera,
                               optics::Imaging imaging, std::optional<double> blur,
                               CameraObservations& observations) {
  const std::unique_ptr<FilmReader> film = openFilm(source);
  const std::int64_t every = std::max<std::int64_t>(1, film->length() / kMostFrames);
  imaging.blur = blur.value_or(imaging.blur);
  CapCollector collector(camera, observations.cap, imaging);
  ProgressBar progress(film->length());
  CameraFrame frame;
  for (std::int64_t i = 0; film->next(frame); ++i) {
    if (i % every == 0) collector.take(frame.grey);
    progress.show(i + 1);
  }
  if (const std::string problem = film->problem(); !problem.empty()) {
    fmt::print("note      {}\n", printable(problem));
  }
  observations.caps = collector.caps();
  return collector.blur();
}

calibration::BoardSpec boardOf(const CalibrateCameraOptions& options) {
  try {
    return calibration::boardFrom(options.board);
  } catch (const std::invalid_argument& error) {
    throw UserError(fmt::format("--board: {}", error.what()));
  }
}

/// Finds the board in the pictures that show all of it. Sets the picture size in `observations`.
void findBoards(const CalibrateCameraOptions& options, CameraObservations& observations) {
  const calibration::BoardSpec board = boardOf(options);
  const std::unique_ptr<FilmReader> pictures = openFilm(options.board_pictures);
  int count = 0;
  for (CameraFrame frame; pictures->next(frame) && observations.boards.size() < kMostBoards;
       ++count) {
    if (count == 0) {
      observations.width = frame.grey.width;
      observations.height = frame.grey.height;
    }
    checkSize(options.board_pictures, observations, frame);
    if (auto view = findBoard(frame.grey, board)) observations.boards.push_back(std::move(*view));
  }
  fmt::print("boards    {} of {} pictures show all {} discs\n", observations.boards.size(), count,
             board.columns * board.rows);
  if (observations.boards.size() < kFewestBoards) {
    throw UserError(fmt::format(
        "{}: found the whole board of {} x {} discs in {} pictures, needed {}: flat, sharp, evenly "
        "lit, and tilted to different sides",
        options.board_pictures, board.columns, board.rows, observations.boards.size(),
        kFewestBoards));
  }
}

/// Calibrates with a board. The caps of a film, if given, improve the pose.
Calibrated calibrateWithBoards(const CalibrateCameraOptions& options,
                               CameraObservations& observations) {
  findBoards(options, observations);
  const CameraFit fit = calibration::fitCamera(observations);
  if (options.source.empty() || !(fit.camera.fx > 0)) return {fit, {}, {}};
  optics::Imaging imaging;
  const std::vector<optics::GreyImage> pictures =
      firstPictures(options.source, observations, imaging);
  const std::optional<double> gamma = findResponse(pictures, fit.camera, observations, imaging);
  const std::optional<double> blur =
      findCaps(options.source, fit.camera, imaging, {}, observations);
  return {calibration::fitCamera(observations, fit.camera), blur, gamma};
}

Calibrated calibrate(const CalibrateCameraOptions& options, CameraObservations& observations) {
  if (!options.board_pictures.empty()) return calibrateWithBoards(options, observations);
  optics::Imaging imaging;
  const std::vector<optics::GreyImage> pictures =
      firstPictures(options.source, observations, imaging);
  Calibrated out;
  CameraFit& fit = out.fit;
  fit.refusal =
      calibration::cornerFault(observations.corners, observations.width, observations.height,
                               observations.arena_width, observations.arena_height);
  if (!fit.refusal.empty()) return out;
  const std::optional<optics::CameraParameters> camera =
      roughCameraOf(observations, pictures, imaging);
  if (!camera) {
    fit.refusal =
        "found no cap in any of the pictures searched: check that they show robots, the "
        "corners, --arena-cm, --cap-height-cm, --spacing-cm, --big-radius-cm, "
        "--small-radius-cm";
    return out;
  }
  out.gamma = findResponse(pictures, *camera, observations, imaging);
  // The first estimate may miss caps where the distortion is largest, so the search and the fit are
  // repeated with the fitted camera.
  calibration::CameraFitLimits anywhere;
  anywhere.caps_in_part = 0;
  out.blur = findCaps(options.source, *camera, imaging, {}, observations);
  fit = calibration::fitCamera(observations, camera, anywhere);
  if (!(fit.camera.fx > 0)) return out;
  out.blur = findCaps(options.source, fit.camera, imaging, out.blur, observations);
  fit = calibration::fitCamera(observations, fit.camera);
  return out;
}

void printDrawing(const char* what, const fs::path& file, const std::string& svg, bool force) {
  checkOutput(file, force);
  replaceFile(file, svg);
  fmt::print("{:<10}{}\n", what, printable(file.string()));
}

/// Films the lab of an experiment file and calibrates with that film.
ExitCode calibrateFromLab(const CalibrateCameraOptions& options) {
  checkOutput(options.out, options.force);
  const FilmedLab lab = filmLab(options);
  CalibrateCameraOptions film = options;
  film.source = lab.pictures;
  film.arena_cm = lab.arena_cm;
  film.origin_cm = lab.origin_cm;
  if (film.corners.empty()) film.corners = lab.corners;
  if (film.corners.empty()) {
    fmt::print(
        "refused   no --corners: read them off {}, then: lab calibrate camera '{}' "
        "--arena-cm {} --origin-cm {} --corners \"...\"\n",
        printable(lab.first), printable(lab.pictures), lab.arena_cm, lab.origin_cm);
    return kFailed;
  }
  return calibrateCamera(film);
}

}  // namespace

ExitCode calibrateCamera(const CalibrateCameraOptions& options) {
  if (!options.print_board.empty()) {
    printDrawing("board", options.print_board, calibration::boardSvg(boardOf(options)),
                 options.force);
  }
  if (!options.print_caps.empty()) {
    printDrawing("caps", options.print_caps, calibration::capSheetSvg(capOf(options)),
                 options.force);
  }
  if (!options.print_board.empty() || !options.print_caps.empty()) return kDone;
  if (fs::path(options.source).extension() == ".toml") return calibrateFromLab(options);
  checkOutput(options.out, options.force);
  if (options.source.empty() && options.board_pictures.empty()) {
    throw UserError(
        "calibrate camera: found neither SOURCE nor --board-pictures, expected a film of "
        "robots, pictures of a board, or both");
  }
  CameraObservations observations = observationsFor(options);
  const Calibrated found = calibrate(options, observations);
  const CameraFit& fit = found.fit;
  if (found.blur) fmt::print("blur      {:.2f} px (standard deviation)\n", *found.blur);
  if (fit.map.rms > 0) fmt::print("{}", calibration::cameraReport(fit));
  if (!fit.refusal.empty()) {
    fmt::print("refused   {}: {}\n",
               printable(options.source.empty() ? options.board_pictures : options.source),
               fit.refusal);
    return kFailed;
  }
  CameraCalibration calibration;
  calibration.camera = fit.camera;
  calibration.cap = observations.cap;
  calibration.arena_width = observations.arena_width;
  calibration.arena_height = observations.arena_height;
  calibration.residual = fit.map.rms;
  moveOrigin(options, calibration);
  if (found.blur || found.gamma) {
    calibration.imaging =
        optics::Imaging{.blur = found.blur.value_or(optics::Imaging{}.blur), .gamma = found.gamma};
  }
  replaceFile(options.out, cameraFileText(calibration));
  fmt::print("camera    {}\n", printable(options.out.string()));
  return kDone;
}

}  // namespace lab::runner
