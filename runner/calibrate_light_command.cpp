#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "calibration/light_margin.hpp"
#include "common/experiment_file.hpp"
#include "common/light_file.hpp"
#include "runner/calibration_lab.hpp"
#include "runner/commands.hpp"
#include "runner/launch.hpp"
#include "runner/light_calibrator.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr double kStart = 60;  // [s]
constexpr double kPercent = 100;

LightCalibration toCalibration(const calibration::LightFit& fit, const Experiment& experiment) {
  LightCalibration calibration;
  calibration.gamma = fit.gamma;
  calibration.vignetting = fit.vignetting;
  calibration.scale = fit.scale;
  calibration.ambient = fit.ambient;
  calibration.residual = fit.residual;
  calibration.arena_width = experiment.arena_width;
  calibration.arena_height = experiment.arena_height;
  for (const auto& [sensor, gain] : fit.gains) {
    SensorGains& gains = calibration.gains[sensor.robot];
    (sensor.front ? gains.front : gains.back) = gain;
  }
  return calibration;
}

void print(const calibration::LightFit& fit, const Experiment& experiment) {
  const optics::ProjectorTone tone(fit.gamma, fit.vignetting, experiment.arena_width,
                                   experiment.arena_height);
  fmt::print("gamma    {:.3f} +- {:.3f}\n", fit.gamma, fit.gamma_sigma);
  fmt::print("white    reads {:.3f} in the middle, {:.1f} % of that where it is weakest\n", fit.scale,
             kPercent * tone.weakest());
  fmt::print("ambient  {:.4f}\n", fit.ambient);
  fmt::print("readings {}, {} at full scale left out; they miss the model by {:.2f} % of full scale, "
             "at most {:.2f} %\n",
             fit.samples, fit.saturated, kPercent * fit.residual, kPercent * fit.worst);
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

void printMargins(const std::vector<calibration::BandMargin>& margins) {
  fmt::print("\nThe light in the middle of each band, with this calibration and without:\n");
  for (const calibration::BandMargin& band : margins) {
    fmt::print("  {:<16} {:.3f}: {:.3f} to the edge, {:.0f} sigma, chance of a wrong reading {:.1e}\n",
               band.program, band.light, band.margin, band.sigmas, band.chance);
    fmt::print("  {:<16} without: robot {}'s {} sensor reads {:.3f} at ({:.0f}, {:.0f}) cm: {}\n", "",
               band.plain_sensor.robot, band.plain_sensor.front ? "front" : "back",
               band.plain_light, kPercent * band.plain_place.x, kPercent * band.plain_place.y,
               band.plain_right ? "inside the band" : "outside the band");
  }
}

Experiment labFor(const Experiment& experiment, int rounds) {
  Experiment lab = labUnderSteadyLight(
      experiment, "-light", kStart + 2 * LightCalibrator::roundTime() * rounds, 1);
  lab.projector.light_calibration.clear();
  return lab;
}

}  // namespace

ExitCode calibrateLight(const CalibrateLightOptions& options) {
  if (fs::exists(options.out) && !options.force) {
    throw UserError(options.out.string() + ": exists; --force replaces it, --out takes another name");
  }
  const Experiment experiment = loadExperiment(options.file, options.set);
  fmt::print("rounds   {}, about {:.0f} s each\n", options.rounds, LightCalibrator::roundTime());
  std::vector<calibration::LightSample> samples;
  const Launched launched = launch(
      {.file = options.file,
       .out = options.runs,
       .programs = options.programs,
       .set = options.set,
       .virtual_time = options.virtual_time},
      labFor(experiment, options.rounds), [](const Progress&) {},
      [&](const ServiceContext& context, Conductor& conductor, std::function<void()> done) {
        const auto tell = [&](int round) {
          fmt::print("round    {} of {}, {} readings\n", round, options.rounds, samples.size());
          std::fflush(stdout);
        };
        return std::make_unique<LightCalibrator>(context, conductor, options.rounds, samples, tell,
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
  std::vector<calibration::BandLimits> bands;
  for (const LightBand& band : experiment.light_table.bands) {
    bands.push_back({band.program, band.low, band.high});
  }
  printMargins(calibration::bandMargins(fit, bands, width, height));
  if (options.force) fs::remove(options.out);
  writeNewFile(options.out, lightFileText(toCalibration(fit, experiment)));
  fmt::print("\nlight    {}\n", fs::absolute(options.out).lexically_normal().string());
  return kDone;
}

}  // namespace lab::runner
