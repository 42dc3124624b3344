#include "runner/runs/place_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "common/camera/camera_place.hpp"
#include "common/camera/camera_source.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/certificate_folder.hpp"
#include "common/serial/serial_line.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

/// False also if this user may not see whether it exists.
bool isAbsent(const fs::path& path) {
  std::error_code error;
  return !fs::exists(path, error) && !error;
}

void checkFolder(const char* key, const std::string& named, const fs::path& source, bool is_read) {
  if (named.empty()) return;
  const fs::path folder = source / named;
  const std::string problem = is_read && !isAbsent(folder)
                                  ? securityFolderProblem(folder, Unreadable::kIsAbsent)
                                  : securityNameProblem(folder);
  if (!problem.empty()) throw UserError(fmt::format("{}: {}", key, problem));
}

void requireFolder(const char* key, const std::string& named, const fs::path& source) {
  if (named.empty()) return;
  const fs::path folder = source / named;
  const std::string problem =
      isAbsent(folder)
          ? folder.string() +
                ": not found, expected a certificate folder as docs/security.md makes it"
          : securityFolderProblem(folder);
  if (!problem.empty()) throw UserError(fmt::format("{}: {}", key, problem));
}

void checkSerialLines(const Experiment& experiment) {
  const bool is_used = std::ranges::any_of(
      experiment.robots, [](const RobotSpec& robot) { return robot.body == Body::kSerial; });
  if (!is_used || !hostOf(experiment, "robot_bridge").empty()) return;
  const std::string other = firstThatIsNoTerminal(experiment.serial.ports);
  if (other.empty()) return;
  throw UserError(
      fmt::format("serial.ports: found \"{}\", which is no serial line, expected devices such as "
                  "/dev/ttyUSB*; robot_bridge --list shows those of this machine",
                  other));
}

void checkCameraPlaces(const Experiment& experiment) {
  if (experiment.camera.tracker != Tracker::kCamera) return;
  if (!hostOf(experiment, "tracker_svc").empty()) return;
  const std::vector<Camera> cameras = camerasOf(experiment);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string& source = cameras[i].source;
    if (source == kSimulatedCamera || source == kPipelineCamera) continue;
    const std::string problem = cameraPlaceProblem(source);
    if (problem.empty()) continue;
    const std::string table = experiment.cameras.empty() ? "camera" : fmt::format("cameras[{}]", i);
    throw UserError(fmt::format("{}.camera: {}", table, problem));
  }
}

}  // namespace

void checkCertificates(const Experiment& experiment, const fs::path& source) {
  checkFolder("link.security", experiment.link.security, source, isLinkedByDds(experiment));
  checkFolder("gateway.security", experiment.gateway.security, source, experiment.gateway.ros);
}

void requireCertificates(const Experiment& experiment, const fs::path& source) {
  if (isLinkedByDds(experiment)) {
    requireFolder("link.security", experiment.link.security, source);
  }
  if (experiment.gateway.ros) {
    requireFolder("gateway.security", experiment.gateway.security, source);
  }
}

void checkDevices(const Experiment& experiment) {
  checkSerialLines(experiment);
  checkCameraPlaces(experiment);
}

}  // namespace lab::runner
