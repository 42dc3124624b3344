#include "common/experiment/experiment_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "common/experiment/service_placement.hpp"

namespace lab {
namespace {

constexpr double kPicture = 1280.0 * 720.0;  // [px] of the measured pictures
constexpr double kWorth = 0.01;              // [1] processes below this are not listed

/// The cost of a process: cores = fixed + robots * robot + frames/s * (frame + robots * both).
struct Cost {
  double fixed = 0;  ///< [1]
  double robot = 0;  ///< [1]
  double frame = 0;  ///< [s]
  double both = 0;   ///< [s]

  [[nodiscard]] double cores(double robots, double frames) const {
    return fixed + robots * robot + frames * (frame + robots * both);
  }
};

// Measured by tests/benchmarks/robots_per_core.py, except where another program is named.
@COSTS@

double count(const Experiment& experiment, Body body) {
  return static_cast<double>(std::ranges::count(experiment.robots, body, &RobotSpec::body));
}

double simulatorCores(const Experiment& experiment) {
  const auto robots = static_cast<double>(std::ranges::count_if(
      experiment.robots, [](const RobotSpec& robot) { return isSimulated(robot.body); }));
  const Camera& camera = experiment.camera;
  double cores = kSimulator.cores(robots, camera.tracker == Tracker::kSimPoses ? camera.fps : 0);
  if (isPainted(camera)) {
    const double pixels = camera.width * camera.height / kPicture;
    cores += camera.fps * (pixels * kPainting.frame + robots * kPainting.both);
  }
  return cores + kNativeDevice * count(experiment, Body::kWire);
}

}  // namespace

std::vector<ProcessLoad> expectedLoad(const Experiment& experiment) {
  const auto robots = static_cast<double>(experiment.robots.size());
  const Camera& camera = experiment.camera;
  const double chips = count(experiment, Body::kFirmware);
  const double on_wire = static_cast<double>(std::ranges::count_if(
      experiment.robots, [](const RobotSpec& robot) { return isOnWire(robot.body); }));
  std::vector<ProcessLoad> all{{"lab", kRunner.cores(robots, camera.fps)},
                               {"lcm-logger", kLogger.cores(robots, camera.fps)}};
  const auto add = [&](std::string_view service, double cores) {
    if (!isNeeded(experiment, service) || !hostOf(experiment, service).empty()) return;
    all.push_back({std::string(service), cores});
  };
  add("analyzer", kAnalyzer.cores(robots, camera.fps));
  add("projector_ctl", kProjector.cores(robots, camera.fps));
  add("robot_bridge", kBridge.cores(on_wire, 0));
  add("sim_svc", simulatorCores(experiment));
  add("dds_gateway", experiment.gateway.ros ? kGateway.cores(robots, camera.fps) : kGateway.fixed);
  add("tracker_svc",
      kTracker.fixed + camera.fps * (kTracker.frame * camera.width * camera.height / kPicture +
                                     robots * kTracker.both));
  if (chips > 0 && hostOf(experiment, "sim_svc").empty()) {
    all.push_back({"robot_emulator", kChips.cores(chips, 0)});
  }
  std::ranges::sort(all, std::ranges::greater(), &ProcessLoad::cores);
  return all;
}

std::string loadProblem(const Experiment& experiment, unsigned cores) {
  double sum = 0;
  std::string list;
  for (const ProcessLoad& process : expectedLoad(experiment)) {
    sum += process.cores;
    if (process.cores < kWorth) continue;
    list += fmt::format("{}{} {:.2f}", list.empty() ? "" : ", ", process.process, process.cores);
  }
  if (cores == 0 || sum <= cores) return {};
  return fmt::format(
      "needs about {:.1f} of {} core{} in real time: {}; lower camera.fps, its pictures or the "
      "number of robots, place services on other hosts, or use --virtual-time",
      sum, cores, cores == 1 ? "" : "s", list);
}

}  // namespace lab
