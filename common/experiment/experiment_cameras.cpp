#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab {

std::vector<Camera> camerasOf(const Experiment& experiment) {
  if (experiment.cameras.empty()) return {experiment.camera};
  std::vector<Camera> cameras;
  for (const CameraSpec& spec : experiment.cameras) {
    Camera& camera = cameras.emplace_back(experiment.camera);
    camera.name = spec.name;
    if (!spec.source.empty()) camera.source = spec.source;
    camera.calibration = spec.calibration;
    if (spec.width > 0) camera.width = spec.width;
    if (spec.height > 0) camera.height = spec.height;
    camera.view = spec.view;
    if (spec.view.width <= 0) camera.view.width = experiment.arena_width - spec.view.x;
    if (spec.view.height <= 0) camera.view.height = experiment.arena_height - spec.view.y;
    camera.clock_error = spec.clock_error;
  }
  return cameras;
}

}  // namespace lab
