#include "common/experiment/checks/camera_checks.hpp"

#include <algorithm>
#include <string>

#include "common/camera/camera_source.hpp"

namespace lab::keys {

void checkCamera(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems) {
  const Camera& camera = form.common.camera;
  const std::string problem = directory ? cameraSourceProblem(camera.source) : std::string();
  if (!problem.empty()) problems.add("camera.camera", problem);
  if (camera.tracker != Tracker::kCamera || problems.concern("camera")) return;
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
