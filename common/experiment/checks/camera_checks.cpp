#include "common/experiment/checks/camera_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

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

}  // namespace

void checkCamera(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems) {
  const Camera& camera = form.common.camera;
  const std::string problem = directory ? cameraSourceProblem(camera.source) : std::string();
  if (!problem.empty()) problems.add("camera.camera", problem);
  if (camera.tracker != Tracker::kCamera || problems.concern("camera")) return;
  checkMarkers(form, problems);
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
