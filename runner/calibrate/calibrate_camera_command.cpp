#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/math/units.hpp"
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
constexpr std::size_t kFirstPictures = 6;  // from which the first idea of the camera is made
constexpr std::size_t kFewestBoards = 4;
constexpr std::size_t kMostBoards = 40;
constexpr std::int64_t kMostFrames = 2000;  // that are searched, evenly over the film

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
    refuse("--spacing-cm", options.spacing_cm, "at least both circles' radii together,", both);
  }
  const double reach =
      std::max(cap.big_offset + cap.big_radius, cap.small_radius - cap.small_offset);
  if (reach > cap.cap_radius) {
    refuse("--cap-radius-cm", options.cap_radius_cm,
           "at least, as far as the circles reach from the axis,", reach / kCenti);
  }
  return cap;
}

CameraObservations sightsFor(const CalibrateCameraOptions& options) {
  CameraObservations sights;
  const std::vector<double> corners = numbersIn(options.corners, ",;");
  if (corners.size() != 8) {
    throw UserError(
        fmt::format("--corners: found \"{}\", expected four pixels \"u,v u,v u,v u,v\": where the "
                    "arena's inner "
                    "corners (0, 0), (width, 0), (width, height), (0, height) are on the floor",
                    options.corners));
  }
  for (std::size_t i = 0; i < 4; ++i) sights.corners[i] = {corners[2 * i], corners[2 * i + 1]};
  const std::vector<double> arena = numbersIn(options.arena_cm, "x");
  if (arena.size() != 2 ||
      !(arena[0] >= 10 && arena[0] <= 2000 && arena[1] >= 10 && arena[1] <= 2000)) {
    throw UserError(
        fmt::format("--arena-cm: found \"{}\", expected width x height as 120x90, each 10 to 2000",
                    options.arena_cm));
  }
  sights.arena_width = kCenti * arena[0];
  sights.arena_height = kCenti * arena[1];
  sights.corner_sigma = options.corner_px;
  sights.cap = capOf(options);
  if (options.camera_height_cm) sights.camera_height = kCenti * *options.camera_height_cm;
  sights.with_k3 = options.k3;
  return sights;
}

void checkSize(const std::string& source, const CameraObservations& sights,
               const CameraFrame& frame) {
  if (frame.grey.width == sights.width && frame.grey.height == sights.height) return;
  throw UserError(fmt::format("{}: frame {} has {} x {} px, expected {} x {} as before", source,
                              frame.number, frame.grey.width, frame.grey.height, sights.width,
                              sights.height));
}

/// Pictures spread over the film, however long it is; their size goes into the sights.
std::vector<optics::GreyImage> firstPictures(const std::string& source, CameraObservations& sights,
                                             optics::Imaging& imaging) {
  const std::unique_ptr<FilmReader> film = openFilm(source);
  imaging.compressed = film->format().compressed;
  std::vector<optics::GreyImage> pictures;
  std::int64_t every = 1;
  CameraFrame frame;
  for (std::int64_t i = 0; film->next(frame); ++i) {
    const optics::GreyView& grey = frame.grey;
    if (sights.width == 0) {
      sights.width = grey.width;
      sights.height = grey.height;
    }
    checkSize(source, sights, frame);
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

/// What a calibration is made of.
struct Calibrated {
  CameraFit fit;
  std::optional<double> blur;   // [px]
  std::optional<double> gamma;  // Imaging::gamma
};

/// How the camera's grey steps follow the light, as far as these pictures tell: read so from now
/// on.
/// @return what is sure enough to be written
std::optional<double> findResponse(const std::vector<optics::GreyImage>& pictures,
                                   const optics::CameraParameters& camera,
                                   const CameraObservations& sights, optics::Imaging& imaging) {
  detector::ResponseFinder finder(optics::CameraModel(camera), sights.cap, imaging);
  for (const optics::GreyImage& picture : pictures) finder.take(picture.view());
  if (finder.gamma()) imaging.gamma = finder.gamma();
  fmt::print("response  gamma {:g}: {}{}\n", imaging.gamma.value_or(1), finder.reason(),
             finder.isSettled() ? "" : "; too little light or caps to be sure, not written");
  return finder.isSettled() ? imaging.gamma : std::nullopt;
}

/// A first idea of the camera, by the reading of its grey steps with which most caps show.
std::optional<optics::CameraParameters> roughCameraOf(
    const CameraObservations& sights, const std::vector<optics::GreyImage>& pictures,
    optics::Imaging& imaging) {
  RoughCamera best;
  optics::Imaging read = imaging;
  for (const double gamma : {1.0, optics::kVideoGamma}) {
    read.gamma = gamma;
    const RoughCamera found = roughCamera(sights, pictures, read);
    if (found.caps <= best.caps) continue;
    best = found;
    imaging.gamma = gamma;
  }
  if (best.caps == 0) return std::nullopt;
  return best.camera;
}

/// The caps of the whole film go into the sights, as they are found with this camera, of this blur
/// if it is known.
/// @return the blur that they have
std::optional<double> findCaps(const std::string& source, const optics::CameraParameters& camera,
                               optics::Imaging imaging, std::optional<double> blur,
                               CameraObservations& sights) {
  const std::unique_ptr<FilmReader> film = openFilm(source);
  const std::int64_t every = std::max<std::int64_t>(1, film->length() / kMostFrames);
  imaging.blur = blur.value_or(imaging.blur);
  CapCollector gathering(camera, sights.cap, imaging);
  ProgressBar progress(film->length());
  CameraFrame frame;
  for (std::int64_t i = 0; film->next(frame); ++i) {
    if (i % every == 0) gathering.take(frame.grey);
    progress.show(i + 1);
  }
  if (const std::string problem = film->problem(); !problem.empty()) {
    fmt::print("note      {}\n", problem);
  }
  sights.caps = gathering.caps();
  return gathering.blur();
}

calibration::BoardSpec boardOf(const CalibrateCameraOptions& options) {
  try {
    return calibration::boardFrom(options.board);
  } catch (const std::invalid_argument& error) {
    throw UserError(fmt::format("--board: {}", error.what()));
  }
}

/// The board in the pictures that show all of it; their size goes into the sights.
void findBoards(const CalibrateCameraOptions& options, CameraObservations& sights) {
  const calibration::BoardSpec board = boardOf(options);
  const std::unique_ptr<FilmReader> pictures = openFilm(options.board_pictures);
  int count = 0;
  for (CameraFrame frame; pictures->next(frame) && sights.boards.size() < kMostBoards; ++count) {
    if (count == 0) {
      sights.width = frame.grey.width;
      sights.height = frame.grey.height;
    }
    checkSize(options.board_pictures, sights, frame);
    if (auto view = findBoard(frame.grey, board)) sights.boards.push_back(std::move(*view));
  }
  fmt::print("boards    {} of {} pictures show all {} discs\n", sights.boards.size(), count,
             board.columns * board.rows);
  if (sights.boards.size() < kFewestBoards) {
    throw UserError(fmt::format(
        "{}: found the whole board of {} x {} discs in {} pictures, needed {}: flat, sharp, evenly "
        "lit, "
        "and tilted to different sides",
        options.board_pictures, board.columns, board.rows, sights.boards.size(), kFewestBoards));
  }
}

/// With a board: caps, where there is a film of them, make the pose more certain.
Calibrated calibrateWithBoards(const CalibrateCameraOptions& options, CameraObservations& sights) {
  findBoards(options, sights);
  const CameraFit fit = calibration::fitCamera(sights);
  if (options.source.empty() || !(fit.camera.fx > 0)) return {fit, {}, {}};
  optics::Imaging imaging;
  const std::vector<optics::GreyImage> pictures = firstPictures(options.source, sights, imaging);
  const std::optional<double> gamma = findResponse(pictures, fit.camera, sights, imaging);
  const std::optional<double> blur = findCaps(options.source, fit.camera, imaging, {}, sights);
  return {calibration::fitCamera(sights, fit.camera), blur, gamma};
}

Calibrated calibrate(const CalibrateCameraOptions& options, CameraObservations& sights) {
  if (!options.board_pictures.empty()) return calibrateWithBoards(options, sights);
  optics::Imaging imaging;
  const std::vector<optics::GreyImage> pictures = firstPictures(options.source, sights, imaging);
  Calibrated out;
  CameraFit& fit = out.fit;
  fit.refusal = calibration::cornerFault(sights.corners, sights.width, sights.height,
                                         sights.arena_width, sights.arena_height);
  if (!fit.refusal.empty()) return out;
  const std::optional<optics::CameraParameters> camera = roughCameraOf(sights, pictures, imaging);
  if (!camera) {
    fit.refusal =
        "found no cap in any of the pictures looked at: are there robots in it, are the "
        "corners right, and --arena-cm, --cap-height-cm, --spacing-cm, --big-radius-cm, "
        "--small-radius-cm?";
    return out;
  }
  out.gamma = findResponse(pictures, *camera, sights, imaging);
  // Once with the first idea, with which caps may be missed where the lens bends most, and once
  // more with what came out.
  calibration::CameraFitLimits anywhere;
  anywhere.caps_in_part = 0;
  out.blur = findCaps(options.source, *camera, imaging, {}, sights);
  fit = calibration::fitCamera(sights, camera, anywhere);
  if (!(fit.camera.fx > 0)) return out;
  out.blur = findCaps(options.source, fit.camera, imaging, out.blur, sights);
  fit = calibration::fitCamera(sights, fit.camera);
  return out;
}

void writeWhole(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  {
    std::ofstream file(part, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw UserError(path.string() + ": cannot be written");
  }
  fs::rename(part, path);
}

void printDrawing(const char* what, const fs::path& file, const std::string& svg, bool force) {
  checkOutput(file, force);
  writeWhole(file, svg);
  fmt::print("{:<10}{}\n", what, file.string());
}

/// Films the lab of an experiment file, and goes on as with any film.
ExitCode calibrateFromLab(const CalibrateCameraOptions& options) {
  checkOutput(options.out, options.force);
  const FilmedLab lab = filmLab(options);
  CalibrateCameraOptions film = options;
  film.source = lab.pictures;
  film.arena_cm = lab.arena_cm;
  if (film.corners.empty()) film.corners = lab.corners;
  if (film.corners.empty()) {
    fmt::print(
        "refused   no --corners: read them off {}, then: lab calibrate camera '{}' "
        "--arena-cm {} --corners \"...\"\n",
        lab.first, lab.pictures, lab.arena_cm);
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
  CameraObservations sights = sightsFor(options);
  const Calibrated found = calibrate(options, sights);
  const CameraFit& fit = found.fit;
  if (found.blur) fmt::print("blur      {:.2f} px (standard deviation)\n", *found.blur);
  if (fit.map.rms > 0) fmt::print("{}", calibration::cameraReport(fit));
  if (!fit.refusal.empty()) {
    fmt::print("refused   {}: {}\n",
               options.source.empty() ? options.board_pictures : options.source, fit.refusal);
    return kFailed;
  }
  CameraCalibration calibration;
  calibration.camera = fit.camera;
  calibration.cap = sights.cap;
  calibration.arena_width = sights.arena_width;
  calibration.arena_height = sights.arena_height;
  calibration.residual = fit.map.rms;
  if (found.blur || found.gamma) {
    calibration.imaging =
        optics::Imaging{.blur = found.blur.value_or(optics::Imaging{}.blur), .gamma = found.gamma};
  }
  writeWhole(options.out, cameraFileText(calibration));
  fmt::print("camera    {}\n", options.out.string());
  return kDone;
}

}  // namespace lab::runner
