#include "runner/calibrate/lab_film.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/math/units.hpp"
#include "light/optics/simulated_camera.hpp"
#include "runner/calibrate/calibration_lab.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/live/launch.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using units::kCm;

constexpr double kDriveStart = 60;  // [s] before the robots drive
constexpr std::int64_t kCheckPeriod_us = 50'000;
constexpr double kPerSecond = 1e6 / LabFilm::kEvery_us;

void writePicture(const fs::path& path, const optics::GreyView& grey) {
  std::ofstream file(path, std::ios::binary);
  file << "P5\n" << grey.width << ' ' << grey.height << "\n255\n";
  for (int y = 0; y < grey.height; ++y) {
    file.write(reinterpret_cast<const char*>(grey.row(y)), grey.width);
  }
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

/// Loads the experiment. If its calibration file does not exist yet, the file to be written takes
/// its place.
Experiment loadForFilming(const CalibrateCameraOptions& options) {
  try {
    return loadExperiment(options.source, options.set);
  } catch (const UserError& error) {
    const std::string problems = error.what();
    std::vector<std::string> set = options.set;
    std::vector<std::string> missing{"camera.calibration"};
    for (std::size_t i = 0; i < keys::kMostCameras; ++i) {
      missing.push_back(fmt::format("cameras[{}].calibration", i));
    }
    for (const std::string& key : missing) {
      if (problems.find(": " + key + ":") == std::string::npos) continue;
      set.push_back(fmt::format("{}=\"{}\"", key, options.out.string()));
    }
    if (set.size() == options.set.size()) throw;
    return loadExperiment(options.source, set);
  }
}

/// Makes one of several cameras the only one.
void selectCamera(const CalibrateCameraOptions& options, Experiment& experiment) {
  std::string names;
  for (const Camera& camera : camerasOf(experiment)) {
    if (camera.name == options.camera) {
      experiment.camera = camera;
      experiment.cameras.clear();
      return;
    }
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  throw UserError(fmt::format(
      "--camera: found {}, expected {} of {}", options.camera.empty() ? "none" : options.camera,
      names.empty() ? "none: there is only one camera" : "one of " + names, options.source));
}

/// The rectangle on the floor whose corners are marked.
CameraView rectangleOf(const Experiment& experiment) {
  if (experiment.camera.view.width > 0) return experiment.camera.view;
  return {0, 0, experiment.arena_width, experiment.arena_height};
}

Experiment labFor(const CalibrateCameraOptions& options) {
  Experiment experiment = loadForFilming(options);
  adopt(options.sources, experiment);
  selectCamera(options, experiment);
  Camera& camera = experiment.camera;
  if (camera.tracker != Tracker::kCamera) {
    throw UserError(options.source +
                    ": camera.tracker: found no camera, expected \"camera\", with "
                    "camera.camera = \"sim\" or a device");
  }
  camera.handshake = false;
  camera.calibration.clear();
  if (isPainted(camera)) {
    // One of several cameras is simulated above an arena of the size of its view.
    camera.view = rectangleOf(experiment);
    experiment.arena_width = camera.view.width;
    experiment.arena_height = camera.view.height;
    camera.fps = kPerSecond;  // more pictures are not needed
  } else {
    camera.tracker = Tracker::kSimPoses;  // a camera allows only one reader
  }
  return labUnderSteadyLight(std::move(experiment), "-camera", kDriveStart + options.film_s, 1);
}

/// The corners of the simulated camera, rounded to 0.1 px as if marked by a careful user.
std::string cornersOf(const Experiment& experiment) {
  const optics::CameraModel camera(
      optics::simulatedCamera(experiment.camera.width, experiment.camera.height,
                              experiment.arena_width, experiment.arena_height));
  const double w = experiment.arena_width;
  const double h = experiment.arena_height;
  std::string text;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {w, 0.0}, {w, h}, {0.0, h}}) {
    const optics::Pixel at = camera.project(x, y, 0);
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", at.x, at.y);
  }
  return text;
}

}  // namespace

LabFilm::LabFilm(const ServiceContext& context, ExperimentController& controller, fs::path folder,
                 std::int64_t pictures, std::function<void()> done)
    : loop_(context.loop),
      experiment_(context.experiment),
      controller_(controller),
      folder_(std::move(folder)),
      wanted_(pictures),
      done_(std::move(done)) {
  fs::create_directories(folder_);
  times_.open(folder_ / "frames.csv");
  times_ << "frame,t_s\n";
  const auto report = [this](const std::string& what) {
    if (!what.empty()) controller_.fault(what);
  };
  try {
    source_ = context.cameras.open(experiment_.camera.source, wantedFormat(experiment_.camera),
                                   {.frame = [this](const CameraFrame& frame) { take(frame); },
                                    .trouble = report,
                                    .end = report});
  } catch (const CameraError& error) {
    throw UserError(error.what());
  }
  loop_.every(kCheckPeriod_us, loop_.now() + kCheckPeriod_us, [this] { startDriving(); });
}

void LabFilm::startDriving() {
  if (driving_ || !controller_.inScript()) return;
  driving_ = true;
  controller_.command(lightTableCommand(experiment_));
}

void LabFilm::take(const CameraFrame& frame) {
  if (!driving_ || kept_ >= wanted_ || frame.utime < next_utime_) return;
  next_utime_ = frame.utime + kEvery_us - kCheckPeriod_us;
  writePicture(folder_ / fmt::format("f{:04d}.pgm", kept_), frame.grey);
  if (kept_ == 0) first_utime_ = frame.utime;
  const double time = units::seconds(frame.utime - first_utime_);
  times_ << fmt::format("{},{:.6f}\n", kept_, time) << std::flush;
  if (!times_) throw std::runtime_error((folder_ / "frames.csv").string() + ": cannot be written");
  if (++kept_ == wanted_) done_();
}

FilmedLab filmLab(const CalibrateCameraOptions& options) {
  Experiment lab = labFor(options);
  const CameraView view = rectangleOf(lab);
  lab.camera.view = {};  // the simulated arena is the view
  lab.camera.name.clear();
  FilmedLab film;
  film.arena_cm = fmt::format("{:.6g}x{:.6g}", kCm * view.width, kCm * view.height);
  film.origin_cm = fmt::format("{:.6g},{:.6g}", kCm * view.x, kCm * view.y);
  if (lab.camera.source == kSimulatedCamera) film.corners = cornersOf(lab);
  film.count = static_cast<std::int64_t>(options.film_s * kPerSecond);
  fmt::print("film     {} pictures, {:.0f} s\n", film.count, options.film_s);
  fs::path folder;
  const Launched launched = launch(
      launchOptions(options.source, options.runs, options), lab, [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        folder = context.directory / files::kCalibration / "film";
        return std::make_unique<LabFilm>(context, controller, folder, film.count, std::move(done));
      });
  printFaults(launched.outcome.faults);
  film.first = (folder / "f0000.pgm").string();
  if (!fs::exists(film.first)) {
    throw UserError(options.source + ": the camera " + lab.camera.source +
                    " gave no picture while the robots drove");
  }
  film.pictures = (folder / "f*.pgm").string();
  return film;
}

}  // namespace lab::runner
