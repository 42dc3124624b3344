#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/calibration/light_file.hpp"
#include "common/calibration/light_margins.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/math/units.hpp"
#include "light/optics/simulated_projector.hpp"
#include "light/photometry/camera_response.hpp"
#include "light/photometry/tone_pictures.hpp"
#include "projector_ctl/calibration/projector_patterns.hpp"
#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/calibrate/calibration_lab.hpp"
#include "runner/calibrate/light_calibrator.hpp"
#include "runner/calibrate/light_margins.hpp"
#include "runner/calibrate/projector_calibrator.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using units::kPercents;

constexpr double kStartTime = 60;         // [s]
constexpr std::int64_t kFrames = 10;      // camera frames per light
constexpr double kSignificant = 4;        // standard errors
constexpr double kRelevant = 0.02;        // relative difference of gamma
constexpr double kLocalDeviation = 0.08;  // relative to white

void print(const calibration::LightFit& fit, const Experiment& experiment) {
  const optics::ProjectorTone tone(fit.gamma, fit.vignetting, experiment.arena_width,
                                   experiment.arena_height);
  fmt::print("gamma    {:.3f} +- {:.4f}\n", fit.gamma, fit.gamma_sigma);
  fmt::print("white    reads {:.3f} in the middle, {:.1f} % of that where it is weakest\n",
             fit.scale, kPercents * tone.weakest());
  fmt::print("ambient  {:.4f}\n", fit.ambient);
  fmt::print(
      "readings {}, {} at full scale left out; deviation from the model {:.2f} % of full scale "
      "rms, at most {:.2f} %\n",
      fit.samples, fit.saturated, kPercents * fit.residual, kPercents * fit.worst);
  fmt::print("\n{:>6} {:>8} {:>8}\n", "robot", "front", "back");
  std::set<std::int32_t> robots;
  for (const auto& [sensor, gain] : fit.gains) robots.insert(sensor.robot);
  const auto gain = [&fit](std::int32_t robot, bool front) {
    const auto found = fit.gains.find({robot, front});
    return found == fit.gains.end() ? 1.0 : found->second;
  };
  for (const std::int32_t robot : robots) {
    fmt::print("{:>6} {:>8.3f} {:>8.3f}\n", robot, gain(robot, true), gain(robot, false));
  }
}

Experiment labFor(const Experiment& experiment, int rounds) {
  Experiment lab = labUnderSteadyLight(experiment, "-light",
                                       kStartTime + 2 * LightCalibrator::roundTime() * rounds, 1);
  lab.projector.light_calibration.clear();
  lab.projector.sync_patch = 0;  // only the staircase is shown
  return lab;
}

/// Shows the staircase again, without robots, and films it with the camera.
/// @return nothing if the lab ended before the end of the staircase
std::optional<std::vector<calibration::ToneObservation>> filmStaircase(
    const Experiment& experiment, const CalibrateLightOptions& options) {
  const std::vector<double>& levels = LightCalibrator::levels();
  std::vector<calibration::LightPattern> lights;
  for (const double level : levels) {
    calibration::LightPattern light;
    light.layer.intensity = level;
    lights.push_back(light);
  }
  Experiment filmed = filmedLab(experiment, "-light-camera", lights.size(), kFrames);
  filmed.projector.light_calibration.clear();
  const bool simulated = filmed.camera.source == kSimulatedCamera;
  // Users are asked to lay a white sheet at sensor height; this simulates it.
  if (simulated) filmed.projector.sheet = optics::kSensorHeight;
  const CameraCalibration camera = cameraOf(experiment, options.file.parent_path()).calibration;
  optics::CameraResponse response(camera.imaging.value_or(optics::Imaging{}));
  calibration::TonePictures pictures(camera.camera, experiment.arena_width, experiment.arena_height,
                                     simulated ? filmed.projector.sheet : 0, levels.size());
  std::string problem = "the lab ended before all lights were shown";
  const Launched launched = launch(
      launchOptions(options.file, options.runs, options), filmed, [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        return std::make_unique<ProjectorCalibrator>(
            context, controller, lights, kFrames,
            [&](std::size_t light, const optics::GreyView& grey) {
              pictures.add(light, response.linear(grey));
            },
            [&problem, done](const std::string& what) {
              problem = what;
              done();
            });
      });
  printFaults(launched.outcome.faults);
  if (problem.empty()) return pictures.observations();
  fmt::print("camera   {}\n", problem);
  return std::nullopt;
}

/// Compares the camera's gamma and white with those from the robots. It is only printed: the
/// robots' sensors decide about the programs.
void printCamera(const std::vector<calibration::ToneObservation>& sights,
                 const calibration::LightFit& fit, const Experiment& experiment) {
  const optics::ProjectorTone known(fit.gamma, fit.vignetting, experiment.arena_width,
                                    experiment.arena_height);
  const calibration::ToneFromPictures seen = calibration::fitTone(
      LightCalibrator::levels(), sights, known, experiment.arena_width, experiment.arena_height);
  if (!seen.refusal.empty()) {
    fmt::print("camera   no result: {}\n", seen.refusal);
    return;
  }
  fmt::print(
      "camera   gamma {:.3f} +- {:.4f} at {} places, {} saturated left out; deviation from the "
      "model {:.2f} % of full scale\n",
      seen.gamma, seen.gamma_sigma, seen.places, seen.saturated, kPercents * seen.residual);
  const double sigma = std::hypot(seen.gamma_sigma, fit.gamma_sigma);
  const double difference = std::abs(seen.gamma - fit.gamma);
  if (difference > kSignificant * sigma && difference > kRelevant * fit.gamma) {
    fmt::print(
        "         differs from the robots' {:.3f}, which is used: check the camera's "
        "calibration (imaging.gamma) and that automatic exposure is off\n",
        fit.gamma);
  } else {
    fmt::print("         agrees with the robots' {:.3f}\n", fit.gamma);
  }
  fmt::print(
      "         white agrees with the robots' within {:.1f} % rms, with the camera's falloff "
      "removed; largest difference at x {:.0f} cm, y {:.0f} cm: {:+.1f} %{}\n",
      kPercents * seen.white_rms, seen.worst_place.x / units::kCentimetre,
      seen.worst_place.y / units::kCentimetre, kPercents * seen.white_worst,
      std::abs(seen.white_worst) > kLocalDeviation
          ? " - is there a shadow, a stain or a reflection?"
          : "");
}

}  // namespace

ExitCode calibrateLight(const CalibrateLightOptions& options) {
  checkOutput(options.out, options.force);
  Experiment experiment = loadExperiment(options.file, options.set);
  adopt(options.sources, experiment);
  fmt::print("rounds   {}, about {:.0f} s each\n", options.rounds, LightCalibrator::roundTime());
  std::vector<calibration::LightSample> samples;
  const Launched launched = launch(
      launchOptions(options.file, options.runs, options), labFor(experiment, options.rounds),
      [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        const auto report_round = [&](int round) {
          fmt::print("round    {} of {}, {} readings\n", round, options.rounds, samples.size());
          std::fflush(stdout);
        };
        return std::make_unique<LightCalibrator>(context, controller, options.rounds, samples,
                                                 report_round, std::move(done));
      });
  printFaults(launched.outcome.faults);
  const double width = experiment.arena_width;
  const double height = experiment.arena_height;
  const calibration::LightFit fit = calibration::fitLight(samples, width, height);
  if (fit.refusal.empty()) print(fit, experiment);
  if (!fit.refusal.empty()) {
    fmt::print("refused  {}; nothing was written\n", fit.refusal);
    return kFailed;
  }
  const LightCalibration found = toCalibration(fit, experiment);
  if (options.camera.value_or(experiment.camera.tracker == Tracker::kCamera)) {
    if (const auto sights = filmStaircase(experiment, options))
      printCamera(*sights, fit, experiment);
  }
  fmt::print("\nLight in the middle of each band:\n{}", marginLines(found, experiment));
  if (options.force) fs::remove(options.out);
  writeNewFile(options.out, lightFileText(found));
  fmt::print("\nlight    {}\n", fs::absolute(options.out).lexically_normal().string());
  return kDone;
}

}  // namespace lab::runner
