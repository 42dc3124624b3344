#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "common/experiment_file.hpp"
#include "common/light_file.hpp"
#include "runner/calibration_lab.hpp"
#include "runner/commands.hpp"
#include "runner/launch.hpp"
#include "runner/light_calibrator.hpp"
#include "runner/light_margins.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr double kStart = 60;  // [s]
constexpr double kPercent = 100;

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

Experiment labFor(const Experiment& experiment, int rounds) {
  Experiment lab = labUnderSteadyLight(
      experiment, "-light", kStart + 2 * LightCalibrator::roundTime() * rounds, 1);
  lab.projector.light_calibration.clear();
  lab.projector.sync_patch = 0;  // nothing but the staircase
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
  const LightCalibration found = toCalibration(fit, experiment);
  fmt::print("\nThe light in the middle of each band:\n{}", marginLines(found, experiment));
  if (options.force) fs::remove(options.out);
  writeNewFile(options.out, lightFileText(found));
  fmt::print("\nlight    {}\n", fs::absolute(options.out).lexically_normal().string());
  return kDone;
}

}  // namespace lab::runner
