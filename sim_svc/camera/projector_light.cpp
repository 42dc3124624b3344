#include "sim_svc/camera/projector_light.hpp"

#include <optional>

#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"

namespace lab::sim {

optics::ProjectorWarp projectorWarpOf(const Experiment& experiment,
                                      const std::filesystem::path& directory) {
  const Projector& projector = experiment.projector;
  if (projector.display != kHeadless) return {};
  const optics::ProjectorModel actual = optics::simulatedProjector(
      experiment.arena_width, experiment.arena_height, projector.width, projector.height,
      {projector.keystone, projector.barrel, projector.offset_x, projector.offset_y});
  return {
      activeProjectorCalibration(experiment, directory, projector.width, projector.height).model,
      actual};
}

optics::ProjectorTones projectorTonesOf(const Experiment& experiment,
                                        const std::filesystem::path& directory) {
  const Projector& projector = experiment.projector;
  if (projector.display != kHeadless) return {};
  const std::optional<LightCalibration> calibration = activeLightCalibration(experiment, directory);
  // V of ProjectorTone: 1 in the middle of the arena, 1 - vignetting in its corners.
  const double quadratic = -projector.vignetting / 2;
  return {calibration ? calibration->tone() : optics::ProjectorTone(),
          {projector.gamma,
           {0, 0, quadratic, 0, quadratic},  // v0 .. v4
           experiment.arena_width,
           experiment.arena_height}};
}

}  // namespace lab::sim
