#include "common/experiment/experiment_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/service_placement.hpp"

namespace lab {
namespace {

constexpr double kPicture = 1280.0 * 720.0;       // [px] of the measured pictures
constexpr double kFilmPicture = 1920.0 * 1080.0;  // [px] of the measured films
constexpr double kListed = 0.01;                  // [1] processes below this are not listed
constexpr const char* kEncoder = "ffmpeg";

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
constexpr Cost kRunner{0.0027, 0.12e-4, 20e-6, 0.25e-6};
constexpr Cost kRecorder{0.0014, 0.28e-4, 20e-6, 0};
constexpr Cost kAnalyzer{0, 11.5e-4, 0, 1.23e-6};
constexpr Cost kProjector{0.0038, 0.06e-4, 10e-6, 0.12e-6};
constexpr Cost kSimulator{0.0040, 0.15e-4, 28e-6, 0.49e-6};    // with the simulated tracker
constexpr Cost kPaintingSimulator{0, 30e-4, 1260e-6, 188e-6};  // paints frames instead
constexpr Cost kTracker{0.0047, 0, 177e-6, 4.5e-6};
constexpr Cost kGateway{0.0034, 1.57e-4, 16e-6, 3.5e-6};
constexpr Cost kBridge{0, 15.5e-4, 0, 0};    // robot_bridge_benchmark.sh
constexpr Cost kChips{0.036, 100e-4, 0, 0};  // robot_emulator: sim_bodies_benchmark
constexpr double kNativeDevice = 0.95e-4;    // [1] in sim_svc: sim_bodies_benchmark
constexpr double kDashboard = 0.03;          // [1] dashboard_clients.py, 100 robots at 20 frames/s

/// The processor time of a frame of a film [s], measured by film_recorder_benchmark (docs/films.md)
/// with pictures of kFilmPicture.
constexpr double filmedFrame(FilmCodec codec) {
  switch (codec) {
    case FilmCodec::kFfvhuff:
      return 5.1e-3;
    case FilmCodec::kH264:
      return 9.0e-3;
    case FilmCodec::kFfv1:
      break;
  }
  return 33e-3;
}
constexpr int kFfv1Slices = 4;  // of a picture, by encodeCommand(): a thread encodes a slice

double count(const Experiment& experiment, Body body) {
  return static_cast<double>(std::ranges::count(experiment.robots, body, &RobotSpec::body));
}

/// Of a process that works on every pixel of every picture. Each of several cameras sees its share
/// of the robots.
double pictureCores(const Cost& cost, double robots, const Experiment& experiment) {
  const std::vector<Camera> cameras = camerasOf(experiment);
  double cores = cost.cores(robots, 0);
  for (const Camera& camera : cameras) {
    const double share = robots / static_cast<double>(cameras.size());
    cores +=
        camera.fps * (cost.frame * camera.width * camera.height / kPicture + share * cost.both);
  }
  return cores;
}

double simulatorCores(const Experiment& experiment) {
  const auto robots = static_cast<double>(std::ranges::count_if(
      experiment.robots, [](const RobotSpec& robot) { return isSimulated(robot.body); }));
  const Camera& camera = experiment.camera;
  double cores = kSimulator.cores(robots, camera.tracker == Tracker::kSimPoses ? camera.fps : 0);
  if (isPainted(camerasOf(experiment).front())) {
    cores = pictureCores(kPaintingSimulator, robots, experiment);
  }
  return cores + kNativeDevice * count(experiment, Body::kWire);
}

/// The encoder of each camera's film is a process of its own.
std::vector<ProcessLoad> filmLoad(const Experiment& experiment) {
  std::vector<ProcessLoad> encoders;
  if (!isFilmed(experiment.camera)) return encoders;
  for (const Camera& camera : camerasOf(experiment)) {
    const FilmSpec& film = camera.film;
    encoders.push_back(
        {.process = kEncoder + (camera.name.empty() ? "" : " of " + camera.name),
         .cores =
             camera.fps * filmedFrame(film.codec) * camera.width * camera.height / kFilmPicture,
         .threads =
             film.codec == FilmCodec::kFfv1 ? std::min(film.threads, kFfv1Slices) : film.threads});
  }
  return encoders;
}

}  // namespace

std::vector<ProcessLoad> expectedLoad(const Experiment& experiment, bool dashboard) {
  const auto robots = static_cast<double>(experiment.robots.size());
  const Camera& camera = experiment.camera;
  const double chips = count(experiment, Body::kFirmware);
  const double on_wire = static_cast<double>(std::ranges::count_if(
      experiment.robots, [](const RobotSpec& robot) { return isOnWire(robot.body); }));
  std::vector<ProcessLoad> all{{"lab", kRunner.cores(robots, camera.fps)},
                               {"recorder", kRecorder.cores(robots, camera.fps)}};
  const auto add = [&](std::string_view service, double cores) {
    if (!isNeeded(experiment, service) || !hostOf(experiment, service).empty()) return;
    all.push_back({std::string(service), cores});
  };
  add("analyzer", kAnalyzer.cores(robots, camera.fps));
  add("projector_ctl", kProjector.cores(robots, camera.fps));
  add("robot_bridge", kBridge.cores(on_wire, 0));
  add("sim_svc", simulatorCores(experiment));
  add("dds_gateway", experiment.gateway.ros ? kGateway.cores(robots, camera.fps) : kGateway.fixed);
  add("tracker_svc", pictureCores(kTracker, robots, experiment));
  if (chips > 0 && hostOf(experiment, "sim_svc").empty()) {
    all.push_back({"robot_emulator", kChips.cores(chips, 0)});
  }
  std::ranges::copy(filmLoad(experiment), std::back_inserter(all));
  if (dashboard) all.push_back({std::string(kObserverService), kDashboard});
  std::ranges::sort(all, std::ranges::greater(), &ProcessLoad::cores);
  return all;
}

std::string loadProblem(const Experiment& experiment, unsigned cores, bool dashboard) {
  double sum = 0;
  std::string list;
  const std::vector<ProcessLoad> processes = expectedLoad(experiment, dashboard);
  for (const ProcessLoad& process : processes) {
    sum += process.cores;
    if (process.cores < kListed) continue;
    list += fmt::format("{}{} {:.2f}", list.empty() ? "" : ", ", process.process, process.cores);
  }
  const auto slow = std::ranges::find_if(
      processes, [](const ProcessLoad& process) { return process.cores > process.threads; });
  std::string problem;
  if (cores > 0 && sum > cores) {
    problem = fmt::format("needs about {:.1f} of {} core{} in real time", sum, cores,
                          cores == 1 ? "" : "s");
  } else if (slow != processes.end()) {
    problem = fmt::format("needs about {:.1f} cores for {} in real time, which can use only {}{}",
                          slow->cores, slow->process,
                          slow->threads == 1 ? "one" : std::to_string(slow->threads),
                          slow->process.starts_with(kEncoder) ? " (camera.record_threads)" : "");
  }
  if (problem.empty()) return {};
  const bool other_codec =
      isFilmed(experiment.camera) && experiment.camera.film.codec != FilmCodec::kFfvhuff;
  return problem + ": " + list +
         "; lower camera.fps, the size of the pictures or the number of robots, " +
         (other_codec ? "set camera.record_codec = \"ffvhuff\", " : "") +
         "place services on other hosts, or use --virtual-time";
}

}  // namespace lab
