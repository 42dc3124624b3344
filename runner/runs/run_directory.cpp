#include "runner/runs/run_directory.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/calibration/camera_file.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/motor_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/camera/recorded_frames.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_log_size.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "dds_gateway/topic_mapping_file.hpp"
#include "light/field/image.hpp"
#include "light/optics/simulated_camera.hpp"
#include "projector_ctl/projector_messages.hpp"
#include "projector_ctl/scene.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/runs/place_checks.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

std::string compactUtc(std::int64_t utime) {
  return fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

std::string sha256(const std::string& text) {
  return light::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// The log for each robot; empty for robots that are not replayed.
std::vector<fs::path> findRecordings(const Experiment& experiment, const fs::path& source) {
  std::vector<fs::path> recordings;
  for (const RobotSpec& robot : experiment.robots) {
    fs::path log;
    if (robot.body == Body::kReplay) {
      log = source / robot.log;
      if (fs::is_directory(log)) log /= files::kLog;
      if (!isLog(log)) {
        throw UserError(
            fmt::format("robots: robot {} replays {}, where there is no log; give the "
                        "folder of a run or a log, relative to the experiment file",
                        robot.id, (source / robot.log).string()));
      }
    }
    recordings.push_back(log);
  }
  return recordings;
}

/// Copied under another name than the calibration that the run may make itself.
void adoptMotors(Experiment& experiment, const fs::path& motors, const fs::path& run) {
  const fs::path name = fs::path(files::kCalibration) / "motors_in_force.toml";
  fs::create_directories(run / files::kCalibration);
  writeNewFile(run / name, readFileText(motors, file_kinds::kCalibration));
  experiment.hardware.motors = name.string();
}

/// @param calibrations in the order of camerasOf()
void adoptCameras(Experiment& experiment, const std::vector<std::string>& calibrations,
                  const fs::path& run) {
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    fs::create_directories(run / files::kCalibration);
    const bool several = !experiment.cameras.empty();
    const std::string of = several ? experiment.cameras[i].name + "_" : std::string();
    const fs::path name = fs::path(files::kCalibration) / ("camera_" + of + "in_force.json");
    writeNewFile(run / name, calibrations[i]);
    std::string& calibration =
        several ? experiment.cameras[i].calibration : experiment.camera.calibration;
    calibration = name.string();
  }
}

void adoptProjector(Experiment& experiment, const fs::path& calibration, const fs::path& run) {
  const fs::path name = fs::path(files::kCalibration) / "projector_in_force.json";
  fs::create_directories(run / files::kCalibration);
  writeNewFile(run / name, readFileText(calibration, file_kinds::kCalibration));
  experiment.projector.calibration = name.string();
}

void adoptLight(Experiment& experiment, const fs::path& calibration, const fs::path& run) {
  const fs::path name = fs::path(files::kCalibration) / "light_in_force.json";
  fs::create_directories(run / files::kCalibration);
  writeNewFile(run / name, readFileText(calibration, file_kinds::kCalibration));
  experiment.projector.light_calibration = name.string();
}

void adoptFrames(Experiment& experiment, const fs::path& frames, const fs::path& run) {
  const fs::path name = "camera_frames.csv";  // frames.csv marks a folder of pictures
  writeNewFile(run / name, readFileText(frames, file_kinds::kFrameTable));
  experiment.camera.frames = name.string();
}

/// What the run stores of the ROS 2 gateway's files; empty: there is none.
struct NetworkFiles {
  std::string mapping;
  std::string configuration;
};

NetworkFiles readNetworkFiles(const Gateway& gateway, const fs::path& source) {
  NetworkFiles files;
  if (!gateway.mapping.empty()) files.mapping = gateway::topicMappingText(source / gateway.mapping);
  if (!gateway.configuration.empty()) {
    files.configuration =
        readFileText(source / gateway.configuration, file_kinds::kDdsConfiguration);
  }
  return files;
}

/// Stores the ROS 2 configuration. Certificates are secret and stay where they are.
void adoptNetwork(Experiment& experiment, const NetworkFiles& network, const fs::path& source,
                  const fs::path& run) {
  const auto adopt = [&](std::string& path, const std::string& text, const char* name) {
    if (path.empty()) return;
    const fs::path to = fs::path("gateway") / name;
    fs::create_directories(run / to.parent_path());
    writeNewFile(run / to, text);
    path = to.string();
  };
  adopt(experiment.gateway.mapping, network.mapping, "mapping.toml");
  adopt(experiment.gateway.configuration, network.configuration, "cyclonedds.xml");
  for (std::string* folder : {&experiment.gateway.security, &experiment.link.security}) {
    if (!folder->empty()) *folder = fs::absolute(source / *folder).string();
  }
}

/// Recordings are large and stay where they are. Their paths become relative to the run's folder.
void adoptRecordings(Experiment& experiment, const std::vector<fs::path>& recordings,
                     const fs::path& run) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (recordings[i].empty()) continue;
    experiment.robots[i].log =
        fs::relative(fs::canonical(recordings[i]), fs::canonical(run)).string();
  }
}

/// Checks a file that an experiment names. Messages begin with the key that names it.
void checkNamedBy(const std::string& key, const std::function<void()>& check) {
  try {
    check();
  } catch (const ExperimentError& error) {
    std::vector<std::string> problems;
    for (const std::string& problem : error.problems()) problems.push_back(key + ": " + problem);
    throw ExperimentError(problems);
  } catch (const UserError& error) {
    throw UserError(key + ": " + error.what());
  }
}

}  // namespace

std::string cameraInForce(const Experiment& experiment, const fs::path& source) {
  const Camera& camera = experiment.camera;
  if (camera.calibration.empty()) {
    CameraCalibration calibration;
    const CameraView& view = camera.view;
    calibration.camera =
        optics::simulatedCameraAbove(camera.width, camera.height, view.x, view.y,
                                     view.width > 0 ? view.width : experiment.arena_width,
                                     view.height > 0 ? view.height : experiment.arena_height);
    calibration.arena_width = experiment.arena_width;
    calibration.arena_height = experiment.arena_height;
    return cameraFileText(calibration);
  }
  const fs::path file = source / camera.calibration;
  const optics::CameraParameters calibrated = readCameraFile(file).camera;
  if (calibrated.width != camera.width || calibrated.height != camera.height) {
    throw UserError(fmt::format(
        "{}: found a calibration of {} x {} pixels, expected {} x {} as width_px and height_px "
        "say; "
        "change them, or calibrate at that size",
        file.string(), calibrated.width, calibrated.height, camera.width, camera.height));
  }
  return readFileText(file, file_kinds::kCalibration);
}

std::vector<std::string> camerasInForce(const Experiment& experiment, const fs::path& source) {
  std::vector<std::string> calibrations;
  Experiment one = experiment;
  for (const Camera& camera : camerasOf(experiment)) {
    one.camera = camera;
    calibrations.push_back(cameraInForce(one, source));
  }
  return calibrations;
}

std::string utcText(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

fs::path makeRunDirectory(const fs::path& parent, const std::string& name, std::int64_t utime,
                          const char* option) {
  std::error_code error;
  fs::create_directories(parent, error);
  const std::string stem = name + "-" + compactUtc(utime);
  for (int number = 1; !error; ++number) {
    const fs::path path = parent / (number == 1 ? stem : fmt::format("{}-{}", stem, number));
    if (fs::create_directory(path, error)) return path;
  }
  throw UserError(fmt::format("cannot make a folder in {}: {}; choose another with {}",
                              parent.string(), error.message(), option));
}

void checkScenes(const Experiment& experiment, const fs::path& source) {
  const ExperimentImages images = loadImages(experiment, source);
  const projector::SceneContext around = projector::sceneContextOf(experiment, images.store);
  for (std::size_t i = 0; i < experiment.light.steps.size(); ++i) {
    const auto layers = toDrivenLayers(experiment.light.steps[i].layers, images);
    if (const auto problem = projector::Scene::problem(layers, around)) {
      throw UserError(fmt::format("light.steps[{}].{}", i, *problem));
    }
  }
}

void adoptImages(Experiment& experiment, const fs::path& source, const fs::path& run) {
  const auto adopt = [&](std::string& image) {
    if (image.empty()) return;
    const fs::path from = source / image;
    const std::string bytes = readFileText(from, file_kinds::kImage);
    const fs::path name = sha256(bytes) + from.extension().string();
    fs::create_directories(run / files::kImages);
    if (!fs::exists(run / files::kImages / name)) writeNewFile(run / files::kImages / name, bytes);
    image = (fs::path(files::kImages) / name).string();
  };
  for (LightStep& step : experiment.light.steps) {
    for (LayerSpec& layer : step.layers) {
      adopt(layer.image);
      for (std::string& image : layer.drive.images) adopt(image);
    }
  }
}

void writeNewFile(const fs::path& path, const std::string& text) {
  if (fs::exists(path)) throw UserError(path.string() + " exists: nothing is overwritten");
  try {
    replaceFile(path, text);
  } catch (const std::runtime_error& error) {
    throw UserError(error.what());
  }
}

std::int64_t diskNeed_bytes(const Experiment& experiment) {
  constexpr double kTrajectoryRow = 130;  // bytes of a line in trajectories.csv
  constexpr double kReserve = 100e6;      // bytes
  const double rows =
      static_cast<double>(experiment.robots.size()) * experiment.camera.fps * experiment.duration;
  return static_cast<std::int64_t>(kReserve + static_cast<double>(expectedLogBytes(experiment)) +
                                   rows * kTrajectoryRow);
}

namespace {

void checkCalibrations(const Experiment& experiment, const fs::path& source) {
  Experiment one = experiment;
  const std::vector<Camera> cameras = camerasOf(experiment);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    one.camera = cameras[i];
    const std::string table = experiment.cameras.empty() ? "camera" : fmt::format("cameras[{}]", i);
    checkNamedBy(table + ".calibration", [&] { static_cast<void>(cameraInForce(one, source)); });
  }
}

}  // namespace

void checkFiles(const Experiment& experiment, const fs::path& source) {
  static_cast<void>(findRecordings(experiment, source));
  const fs::path motors = experiment.hardware.motors;
  if (!motors.empty()) {
    checkNamedBy("robot.motors", [&] { static_cast<void>(readMotorFile(source / motors)); });
  }
  if (experiment.camera.tracker == Tracker::kCamera) {
    checkCalibrations(experiment, source);
  }
  checkNamedBy("projector.calibration", [&] { checkProjectorFile(experiment, source); });
  const fs::path frames = experiment.camera.frames;
  if (!frames.empty()) {
    checkNamedBy("camera.frames", [&] { static_cast<void>(readRecordedFrames(source / frames)); });
  }
  checkNamedBy("projector.light_calibration",
               [&] { static_cast<void>(activeLightCalibration(experiment, source)); });
  checkScenes(experiment, source);
  static_cast<void>(readNetworkFiles(experiment.gateway, source));
  checkCertificates(experiment, source);
  checkDevices(experiment);
}

PreparedRun prepareRun(Experiment experiment, const fs::path& source, const fs::path& parent,
                       std::int64_t utime, const char* option) {
  checkFiles(experiment, source);
  return prepareCheckedRun(std::move(experiment), source, parent, utime, option);
}

PreparedRun prepareCheckedRun(Experiment experiment, const fs::path& source, const fs::path& parent,
                              std::int64_t utime, const char* option) {
  PreparedRun run;
  const std::vector<fs::path> recordings = findRecordings(experiment, source);
  const fs::path motors = experiment.hardware.motors;
  const bool by_camera = experiment.camera.tracker == Tracker::kCamera;
  const std::vector<std::string> cameras =
      by_camera ? camerasInForce(experiment, source) : std::vector<std::string>();
  const fs::path projector = experiment.projector.calibration;
  const fs::path light = experiment.projector.light_calibration;
  const fs::path frames = experiment.camera.frames;
  const NetworkFiles network = readNetworkFiles(experiment.gateway, source);
  run.directory = makeRunDirectory(parent, experiment.name, utime, option);
  if (!motors.empty()) adoptMotors(experiment, source / motors, run.directory);
  adoptCameras(experiment, cameras, run.directory);
  if (!projector.empty()) adoptProjector(experiment, source / projector, run.directory);
  if (!light.empty()) adoptLight(experiment, source / light, run.directory);
  if (!frames.empty()) adoptFrames(experiment, source / frames, run.directory);
  adoptRecordings(experiment, recordings, run.directory);
  adoptImages(experiment, source, run.directory);
  adoptNetwork(experiment, network, source, run.directory);
  run.effective = writeExperiment(experiment);
  run.experiment = std::move(experiment);
  writeNewFile(run.directory / files::kExperiment, run.effective);
  return run;
}

}  // namespace lab::runner
