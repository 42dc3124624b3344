#include "common/experiment/checks/camera_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/camera/camera_source.hpp"

namespace lab::keys {

namespace {

/// Sizes of blobs, and robots whose ids no tag has.
void checkMarkers(const ExperimentForm& form, Problems& problems) {
  const Camera& camera = form.common.camera;
  if (camera.marker == Marker::kBlobs && camera.blob_smallest >= camera.blob_largest) {
    problems.add("camera.blob_smallest_cm", "not below camera.blob_largest_cm");
  }
  if (camera.marker != Marker::kTags || problems.concern("robots")) return;
  const TagFamilyEntry family = entryOf(camera.tag_family);
  for (const RobotEntry& entry : form.robots) {
    const std::int64_t last = entry.id + entry.count - 1;
    if (last < family.tags) continue;
    problems.add("camera.tag_family",
                 "found \"" + std::string(family.name) + "\", whose tags are 0 to " +
                     std::to_string(family.tags - 1) + ", and robot " + std::to_string(last) +
                     "; allowed: a family with its number, or other ids");
    return;
  }
}

/// What works with one camera only.
void checkOptions(const Camera& camera, Problems& problems) {
  if (camera.marker == Marker::kBlobs) {
    problems.add("camera.marker",
                 "found \"blobs\" and several cameras; allowed: caps or tags, or one camera");
  }
  if (camera.debug_port != 0) {
    problems.add("camera.debug_port",
                 "found a port and several cameras; allowed: 0, or one camera");
  }
}

void checkView(const Experiment& experiment, const CameraView& view, const std::string& path,
               Problems& problems) {
  const auto check = [&](const char* key, double from, double size, double arena) {
    constexpr double kRounding = 1e-9;  // [m]
    if (from + size <= arena + kRounding && from < arena) return;
    problems.add(path + key, "found a view that ends outside the arena, allowed one inside");
  };
  check(".view_width_cm", view.x, view.width, experiment.arena_width);
  check(".view_height_cm", view.y, view.height, experiment.arena_height);
}

void checkCameras(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                  Problems& problems) {
  const Experiment& experiment = form.common;
  if (problems.concern("cameras")) return;
  checkOptions(experiment.camera, problems);
  const std::vector<Camera> cameras = camerasOf(experiment);
  if (cameras.size() < 2) {
    problems.add("cameras", "found one camera, allowed 2 to 8; for one, [camera] is enough");
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i];
    const std::string path = "cameras[" + std::to_string(i) + "]";
    const std::string problem = directory ? cameraSourceProblem(camera.source) : std::string();
    if (!problem.empty()) problems.add(path + ".camera", problem);
    if (isPainted(camera) != isPainted(cameras[0])) {
      problems.add(path + ".camera",
                   "found real and simulated cameras, allowed only real or only simulated ones");
    }
    if (!isPainted(camera) && camera.calibration.empty()) {
      problems.add(path + ".calibration", "found none, needed for any camera but \"sim\"");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (cameras[k].name == camera.name) {
        problems.add(path + ".name", "found \"" + camera.name + "\", the name of cameras[" +
                                         std::to_string(k) + "] too; allowed: another name");
      }
      if (!isPainted(camera) && cameras[k].source == camera.source) {
        problems.add(path + ".camera", "found \"" + camera.source + "\", the source of cameras[" +
                                           std::to_string(k) + "] too; allowed: another source");
      }
    }
    checkView(experiment, camera.view, path, problems);
  }
}

}  // namespace

void checkCamera(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems) {
  const Camera& camera = form.common.camera;
  const std::string problem = directory ? cameraSourceProblem(camera.source) : std::string();
  if (!problem.empty()) problems.add("camera.camera", problem);
  if (camera.tracker != Tracker::kCamera && !form.common.cameras.empty()) {
    problems.add("cameras",
                 "found cameras that nobody reads, allowed only with camera.tracker = "
                 "\"camera\"");
  }
  if (camera.tracker != Tracker::kCamera || problems.concern("camera")) return;
  checkMarkers(form, problems);
  if (!form.common.cameras.empty()) return checkCameras(form, directory, problems);
  if (camera.source.empty()) {
    problems.add("camera.camera", "found an empty text, allowed \"sim\", a device, a film, ...");
  } else if (!isPainted(camera) && camera.calibration.empty()) {
    problems.add("camera.calibration",
                 "found none, needed for any camera but \"sim\" (lab calibrate camera)");
  } else if (!isPainted(camera) && !problems.concern("robots") &&
             std::ranges::none_of(form.robots, [](const RobotEntry& entry) {
               return entry.body == Body::kSerial;
             })) {
    problems.add("camera.camera", "found \"" + camera.source +
                                      "\", but no robot with body = \"serial\" that it could see; "
                                      "simulated robots are seen by camera = \"sim\"");
  }
}

}  // namespace lab::keys
