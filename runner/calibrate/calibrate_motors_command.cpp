#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "robot_bridge/calibration/drive_pattern.hpp"
#include "robot_bridge/calibration/motor_report.hpp"
#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/calibrate/calibration_lab.hpp"
#include "runner/calibrate/motor_calibrator.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr double kMostPerRobot = 180;  // [s] if every timeout is used up
constexpr double kRobotsStart = 60;    // [s]
constexpr double kOverhead = 5;        // [s] per robot for turning and storing

std::vector<std::int32_t> chosenRobots(const Experiment& experiment,
                                       const std::vector<std::int32_t>& wanted) {
  const std::vector<std::int32_t> all = commandedRobots(experiment);
  for (const std::int32_t id : wanted) {
    if (std::ranges::find(all, id) != all.end()) continue;
    std::string known;
    for (const std::int32_t robot : all) known += fmt::format(" {}", robot);
    throw UserError(fmt::format("--robot {}: found no such robot that takes commands, allowed{}",
                                id, known.empty() ? " none" : known));
  }
  return wanted.empty() ? all : wanted;
}

/// The lab of the calibration, with the longest possible duration.
Experiment labFor(const Experiment& experiment, std::size_t robots) {
  return labUnderSteadyLight(experiment, "-motors",
                             kRobotsStart + kMostPerRobot * static_cast<double>(robots),
                             experiment.light.safe_intensity);
}

/// Usual time for one robot [s].
double usualTime(double max) {
  double time = kOverhead;
  for (const auto& pattern :
       {calibration::checkPattern(max), calibration::calibrationPattern({}, max),
        calibration::checkPattern(max)}) {
    for (const auto& step : pattern) time += step.duration + calibration::kSettleTime;
  }
  return time;
}

}  // namespace

ExitCode calibrateMotors(const CalibrateOptions& options) {
  Experiment experiment = loadExperiment(options.file, options.set);
  adopt(options.sources, experiment);
  const std::vector<std::int32_t> robots = chosenRobots(experiment, options.robots);
  if (robots.empty()) {
    throw UserError(options.file.string() + ": no robot takes commands: nothing to calibrate");
  }
  fmt::print("robots   {}, one after the other, about {:.0f} s each\n", robots.size(),
             usualTime(experiment.hardware.max_wheel_speed));

  std::vector<calibration::MotorReport> reports;
  const auto add_report = [&reports](const calibration::MotorReport& report) {
    if (reports.empty()) fmt::print("\n{}", calibration::tableHead());
    fmt::print("{}", calibration::tableLine(report));
    std::fflush(stdout);
    reports.push_back(report);
  };
  const Launched launched = launch(
      launchOptions(options.file, options.out, options), labFor(experiment, robots.size()),
      [](const Progress&) {},
      [&](const ServiceContext& context, ExperimentController& controller,
          std::function<void()> done) {
        return std::make_unique<MotorCalibrator>(context, controller, robots, add_report,
                                                 std::move(done));
      });

  printFaults(launched.outcome.faults);
  const fs::path folder = launched.directory / files::kCalibration;
  fs::create_directories(folder);
  writeNewFile(folder / "motors.toml", calibration::motorsFile(reports));
  fmt::print("\nmotors   {}\n", fs::absolute(folder / "motors.toml").lexically_normal().string());

  const auto refused =
      std::ranges::count_if(reports, [](const auto& report) { return !report.refusal.empty(); });
  const std::size_t missing = robots.size() - reports.size();
  if (missing > 0)
    fmt::print("ended before {} of {} robots were calibrated\n", missing, robots.size());
  if (launched.outcome.closed_early) return kClosedEarly;
  return refused > 0 || missing > 0 ? kFailed : kDone;
}

}  // namespace lab::runner
