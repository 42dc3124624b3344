#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "common/calibration/light_file.hpp"
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
#include "runner/live/launch.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using units::kPercents;

constexpr double kLightsStart = 60;   // [s]
constexpr std::int64_t kFrames = 10;  // of the camera, of each light
constexpr double kSurelyApart = 4;    // standard errors
constexpr double kNoticeable = 0.02;  // of gamma
constexpr double kLocalFault = 0.08;  // of the white

void print(const calibration::LightFit& fit, const Experiment& experiment) {
  const optics::ProjectorTone tone(fit.gamma, fit.vignetting, experiment.arena_width,
                                   experiment.arena_height);
  fmt::print("gamma    {:.3f} +- {:.4f}\n", fit.gamma, fit.gamma_sigma);
  fmt::print("white    reads {:.3f} in the middle, {:.1f} % of that where it is weakest\n",
             fit.scale, kPercents * tone.weakest());
  fmt::print("ambient  {:.4f}\n", fit.ambient);
  fmt::print(
      "readings {}, {} at full scale left out; they miss the model by {:.2f} % of full scale, "
      "at most {:.2f} %\n",
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
                                       kLightsStart + 2 * LightCalibrator::roundTime() * rounds, 1);
  lab.projector.light_calibration.clear();
  lab.projector.sync_patch = 0;  // nothing but the staircase
  return lab;
}

/// Shows the staircase once more, without robots, to a camera.
/// @return nothing when the lab ended before that
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
  // What users are asked to lay: robots would be seen as places that lack light.
  if (simulated) filmed.projector.sheet = optics::kSensorHeight;
  const CameraCalibration camera = cameraOf(experiment, options.file.parent_path()).calibration;
  optics::CameraResponse response(camera.imaging.value_or(optics::Imaging{}));
  calibration::TonePictures pictures(camera.camera, experiment.arena_width, experiment.arena_height,
                                     simulated ? filmed.projector.sheet : 0, levels.size());
  std::string problem = "the lab ended before the lights did";
  const Launched launched = launch(
      {.file = options.file,
       .out = options.runs,
       .programs = options.programs,
       .set = options.set,
       .run_virtual = virtualTimeIf(options.virtual_time),
       .cameras = realCameras},
      filmed, [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        return std::make_unique<ProjectorCalibrator>(
            context, controller, lights, kFrames,
            [&](std::size_t light, const optics::GreyView& grey) {
              pictures.take(light, response.linear(grey));
            },
            [&problem, done](const std::string& what) {
              problem = what;
              done();
            });
      });
  for (const std::string& fault : launched.outcome.faults) fmt::print("marked   {}\n", fault);
  if (problem.empty()) return pictures.sights();
  fmt::print("camera   {}\n", problem);
  return std::nullopt;
}

/// What the camera says beside the robots. It changes nothing: the sensors choose the programs.
void printCamera(const std::vector<calibration::ToneObservation>& sights,
                 const calibration::LightFit& fit, const Experiment& experiment) {
  const optics::ProjectorTone known(fit.gamma, fit.vignetting, experiment.arena_width,
                                    experiment.arena_height);
  const calibration::ToneFromPictures seen = calibration::fitTone(
      LightCalibrator::levels(), sights, known, experiment.arena_width, experiment.arena_height);
  if (!seen.refusal.empty()) {
    fmt::print("camera   says nothing: {}\n", seen.refusal);
    return;
  }
  fmt::print(
      "camera   gamma {:.3f} +- {:.4f} at {} places, {} saturated left out; misses the model by "
      "{:.2f} % of full scale\n",
      seen.gamma, seen.gamma_sigma, seen.places, seen.saturated, kPercents * seen.residual);
  const double sigma = std::hypot(seen.gamma_sigma, fit.gamma_sigma);
  const double apart = std::abs(seen.gamma - fit.gamma);
  if (apart > kSurelyApart * sigma && apart > kNoticeable * fit.gamma) {
    fmt::print(
        "         that is not the robots' {:.3f}, which counts: is the camera's own curve "
        "as its calibration says (imaging.gamma, no automatic exposure)?\n",
        fit.gamma);
  } else {
    fmt::print("         agrees with the robots' {:.3f}\n", fit.gamma);
  }
  fmt::print(
      "         white as the robots found it within {:.1f} % rms, the camera's own falloff "
      "taken out; most at x {:.0f} cm, y {:.0f} cm: {:+.1f} %{}\n",
      kPercents * seen.white_rms, seen.worst_place.x / units::kCentimetre,
      seen.worst_place.y / units::kCentimetre, kPercents * seen.white_worst,
      std::abs(seen.white_worst) > kLocalFault ? " - a shadow, a stain or a reflection there?"
                                               : "");
}

}  // namespace

ExitCode calibrateLight(const CalibrateLightOptions& options) {
  if (fs::exists(options.out) && !options.force) {
    throw UserError(options.out.string() +
                    ": exists; --force replaces it, --out takes another name");
  }
  const Experiment experiment = loadExperiment(options.file, options.set);
  fmt::print("rounds   {}, about {:.0f} s each\n", options.rounds, LightCalibrator::roundTime());
  std::vector<calibration::LightSample> samples;
  const Launched launched = launch(
      {.file = options.file,
       .out = options.runs,
       .programs = options.programs,
       .set = options.set,
       .run_virtual = virtualTimeIf(options.virtual_time),
       .cameras = realCameras},
      labFor(experiment, options.rounds), [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        const auto tell = [&](int round) {
          fmt::print("round    {} of {}, {} readings\n", round, options.rounds, samples.size());
          std::fflush(stdout);
        };
        return std::make_unique<LightCalibrator>(context, controller, options.rounds, samples, tell,
                                                 std::move(done));
      });
  for (const std::string& fault : launched.outcome.faults) fmt::print("marked   {}\n", fault);
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
  fmt::print("\nThe light in the middle of each band:\n{}", marginLines(found, experiment));
  if (options.force) fs::remove(options.out);
  writeNewFile(options.out, lightFileText(found));
  fmt::print("\nlight    {}\n", fs::absolute(options.out).lexically_normal().string());
  return kDone;
}

}  // namespace lab::runner
