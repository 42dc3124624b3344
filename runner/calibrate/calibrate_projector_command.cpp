#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/math/units.hpp"
#include "light/field/image.hpp"
#include "light/optics/simulated_projector.hpp"
#include "projector_ctl/calibration/projector_fit.hpp"
#include "projector_ctl/calibration/projector_patterns.hpp"
#include "projector_ctl/calibration/projector_report.hpp"
#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/calibrate/calibration_lab.hpp"
#include "runner/calibrate/projector_calibrator.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using units::kCentimetre;

constexpr double kAtSensors = 1e-3;  // [m] tolerance of the surface height

Experiment labFor(Experiment experiment, const CalibrateProjectorOptions& options) {
  experiment.projector.calibration.clear();
  return filmedLab(
      std::move(experiment), "-projector",
      calibration::projectorPatterns(experiment.arena_width, experiment.arena_height).size(),
      options.frames);
}

std::optional<std::array<double, 3>> projectorPlace(const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::array<double, 3> place{};
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  bool good = parts.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    good = CLI::detail::lexical_cast(parts[i], place[i]) && std::abs(place[i]) < 10'000;
    place[i] *= kCentimetre;
  }
  if (!good || !(place[2] > 0.2)) {
    throw UserError(fmt::format(
        "--projector-cm: found \"{}\", expected x,y,z of the projector's lens in cm, as 60,118,210",
        text));
  }
  return place;
}

/// Height of the surface that is filmed [m above the floor].
double surfaceOf(const Experiment& experiment, const CalibrateProjectorOptions& options) {
  const bool simulated =
      isPainted(experiment.camera) || experiment.camera.source == kSimulatedCamera;
  const double surface = options.surface_cm ? *options.surface_cm * kCentimetre
                         : simulated        ? experiment.projector.sheet
                                            : optics::kSensorHeight;
  if (std::abs(surface - optics::kSensorHeight) <= kAtSensors || !options.projector_cm.empty()) {
    return surface;
  }
  throw UserError(fmt::format(
      "the light would be measured {:g} cm above the floor, but is needed at {:g} cm, the height "
      "of "
      "the robots' light sensors, where it falls on other places. {}; or give the place of the "
      "projector's lens with --projector-cm x,y,z, so that this can be computed",
      surface / kCentimetre, optics::kSensorHeight / kCentimetre,
      simulated ? "Lay the simulated white sheet: --set projector.sheet_cm=5"
                : "Lay a white board on spacers of 5 cm, and leave out --surface-cm"));
}

void setResolution(const Experiment& experiment, const CalibrateProjectorOptions& options,
                   calibration::ProjectorPlane& plane) {
  plane.columns = experiment.projector.width;
  plane.rows = experiment.projector.height;
  if (experiment.projector.display == kHeadless) return;
  const std::vector<std::string> parts = CLI::detail::split(options.resolution, 'x');
  if (parts.size() == 2 && CLI::detail::lexical_cast(parts[0], plane.columns) &&
      CLI::detail::lexical_cast(parts[1], plane.rows) && plane.columns > 0 && plane.rows > 0) {
    return;
  }
  throw UserError(
      fmt::format("--resolution: found \"{}\", expected the pixels of the display \"{}\" as "
                  "1920x1080 (projector_ctl --list-displays)",
                  options.resolution, experiment.projector.display));
}

calibration::PatternReader readerFor(const Experiment& experiment, const fs::path& directory,
                                     const CalibrateProjectorOptions& options,
                                     calibration::PatternView& view) {
  view.surface = surfaceOf(experiment, options);
  view.projector = projectorPlace(options.projector_cm);
  view.plane.arena_width = experiment.arena_width;
  view.plane.arena_height = experiment.arena_height;
  view.plane.height = optics::kSensorHeight;
  setResolution(experiment, options, view.plane);
  view.camera = cameraOf(experiment, directory).calibration.camera;
  view.assumed = optics::ProjectorModel(experiment.arena_width, experiment.arena_height,
                                        view.plane.columns, view.plane.rows);
  try {
    return {view, calibration::projectorPatterns(experiment.arena_width, experiment.arena_height)};
  } catch (const std::invalid_argument& error) {
    throw UserError(fmt::format("--projector-cm, --surface-cm: {}", error.what()));
  }
}

std::string countText(const calibration::PatternCount& count) {
  const auto share = [&](int part) { return 100.0 * part / std::max(1, count.pixels); };
  return fmt::format(
      "pixels    {} of the camera show the arena; {:.1f} % see no difference between "
      "bright and dark, {:.1f} % are saturated, {:.1f} % unclear\n",
      count.pixels, share(count.dark), share(count.saturated), share(count.unclear));
}

fs::path pictureBeside(const fs::path& out) {
  fs::path picture = out;
  picture.replace_extension();
  picture += "-residuals.png";
  return picture;
}

void writePicture(const fs::path& path, const calibration::ProjectorFit& fit,
                  const calibration::ProjectorPlane& plane) {
  const calibration::ResidualPicture picture = calibration::residualPicture(fit, plane);
  const auto png = light::encodePng(picture.columns, picture.rows, picture.grey);
  replaceFile(path, png);
  fmt::print("picture   {} (arrows {:.0f} times as long as the residuals)\n", path.string(),
             picture.scale);
}

ExitCode writeResult(const calibration::ProjectorFit& fit, const calibration::ProjectorPlane& plane,
                     const std::string& camera_id, const CalibrateProjectorOptions& options) {
  if (fit.covered > 0) {
    fmt::print("{}", calibration::projectorReport(fit, plane));
    writePicture(pictureBeside(options.out), fit, plane);
  }
  if (!fit.refusal.empty()) {
    fmt::print("refused   {}\n", fit.refusal);
    return kFailed;
  }
  ProjectorCalibration calibration;
  calibration.lens = fit.lens;
  calibration.height = plane.height;
  calibration.arena_width = plane.arena_width;
  calibration.arena_height = plane.arena_height;
  calibration.method = "camera";
  calibration.camera_id = camera_id;
  calibration.residual = fit.residual;
  calibration.accuracy = fit.accuracy;
  calibration.worst = fit.worstResidual();
  calibration.covered = fit.covered;
  replaceFile(options.out, projectorFileText(calibration));
  fmt::print("projector {}\n", options.out.string());
  return kDone;
}

}  // namespace

ExitCode calibrateProjector(const CalibrateProjectorOptions& options) {
  checkOutput(options.out, options.force);
  checkOutput(pictureBeside(options.out), options.force);
  Experiment experiment = loadExperiment(options.file, options.set);
  adopt(options.sources, experiment);
  const fs::path directory = options.file.parent_path();
  calibration::PatternView view;
  calibration::PatternReader reader = readerFor(experiment, directory, options, view);
  const KnownCamera camera = cameraOf(experiment, directory);
  const auto patterns =
      calibration::projectorPatterns(experiment.arena_width, experiment.arena_height);
  fmt::print("patterns {}, {} pictures each\n", patterns.size(), options.frames);
  std::string problem = "the lab ended before all patterns were shown";
  const Launched launched = launch(
      launchOptions(options.file, options.runs, options), labFor(experiment, options),
      [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        return std::make_unique<ProjectorCalibrator>(
            context, controller, patterns, options.frames,
            [&](std::size_t pattern, const optics::GreyView& grey) { reader.add(pattern, grey); },
            [&problem, done](const std::string& what) {
              problem = what;
              done();
            });
      });
  printFaults(launched.outcome.faults);
  if (!problem.empty()) {
    fmt::print("refused   {}\n", problem);
    return launched.outcome.closed_early ? kClosedEarly : kFailed;
  }
  fmt::print("{}", countText(reader.count()));
  return writeResult(calibration::fitProjector(reader.observations(), view.plane, camera.error),
                     view.plane, camera.calibration.id, options);
}

}  // namespace lab::runner
