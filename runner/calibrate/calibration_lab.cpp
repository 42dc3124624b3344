#include "runner/calibrate/calibration_lab.hpp"

#include <algorithm>

#include "light/optics/simulated_camera.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/runs/run_directory.hpp"
#include "runner/virtual_time/run_virtual.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace lab::runner {
namespace {

constexpr double kStart = 60;         // [s] before the first light
constexpr double kPerLight = 12;      // [s] at most, without the frames
constexpr double kSimulatedFps = 20;  // [1/s] more pictures are not needed

}  // namespace

Experiment labUnderSteadyLight(Experiment experiment, const std::string& suffix, double duration,
                               double intensity) {
  experiment.name += suffix;
  experiment.duration = duration;
  experiment.camera.film = {};
  LayerSpec uniform;
  uniform.intensity = intensity;
  LightStep step;
  step.label = "calibration";
  step.layers = {uniform};
  experiment.light.steps = {step};
  experiment.light.length = 0;
  experiment.light.repeat = false;
  return experiment;
}

Experiment filmedLab(Experiment experiment, const std::string& suffix, std::size_t lights,
                     std::int64_t frames) {
  if (!experiment.cameras.empty()) {
    throw UserError(
        "cameras: found several cameras, allowed one that sees the whole projector's picture; use "
        "a file without [[cameras]]");
  }
  Camera& camera = experiment.camera;
  camera.handshake = false;
  camera.calibration.clear();
  if (camera.source == kSimulatedCamera) {
    camera.tracker = Tracker::kCamera;  // otherwise no pictures are painted
    camera.fps = std::min(camera.fps, kSimulatedFps);
  } else {
    camera.tracker = Tracker::kSimPoses;  // a camera allows only one reader
  }
  RobotSpec robot;
  robot.id = experiment.robots.front().id;
  experiment.robots = {robot};
  experiment.projector.sync_patch = 0;
  const double filmed = static_cast<double>(frames) / camera.fps;
  return labUnderSteadyLight(std::move(experiment), suffix,
                             kStart + static_cast<double>(lights) * (kPerLight + filmed), 0);
}

RunVirtual virtualTimeIf(bool wanted) { return wanted ? RunVirtual(runVirtual) : RunVirtual(); }

std::unique_ptr<Cameras> realCameras(AsioLoop& loop, const std::filesystem::path& folder) {
  return std::make_unique<CameraDevices>(loop, folder);
}

KnownCamera cameraOf(const Experiment& experiment, const std::filesystem::path& directory) {
  const Camera& camera = experiment.camera;
  KnownCamera out;
  if (camera.calibration.empty()) {
    if (camera.source != kSimulatedCamera) {
      throw UserError(
          "camera.calibration: found none, expected the camera.json of this camera; run lab "
          "calibrate camera first");
    }
    out.calibration.camera = optics::simulatedCamera(
        camera.width, camera.height, experiment.arena_width, experiment.arena_height);
    return out;
  }
  static_cast<void>(cameraInForce(experiment, directory));  // throws if it cannot be used
  out.calibration = readCameraFile(directory / camera.calibration);
  out.error = out.calibration.residual.value_or(0);
  return out;
}

}  // namespace lab::runner
