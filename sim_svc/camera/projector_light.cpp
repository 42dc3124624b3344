#include "sim_svc/camera/projector_light.hpp"

#include <optional>

#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"

namespace lab::sim {

optics::ProjectorWarp projectorWarpOf(const Experiment& experiment,
                                      const std::filesystem::path& directory) {
  const Projector& projector = experiment.projector;
  if (projector.display != kHeadless) return {};
  const optics::ProjectorModel real = optics::simulatedProjector(
      experiment.arena_width, experiment.arena_height, projector.width, projector.height,
      {projector.keystone, projector.barrel, projector.offset_x, projector.offset_y});
  return {
      activeProjectorCalibration(experiment, directory, projector.width, projector.height).model,
      real};
}

optics::ProjectorTones tonesOf(const Experiment& experiment,
                               const std::filesystem::path& directory) {
  const Projector& projector = experiment.projector;
  if (projector.display != kHeadless) return {};
  const std::optional<LightCalibration> calibration = activeLightCalibration(experiment, directory);
  // The light in a corner is lower than in the middle by the share `vignetting`.
  const double side = -projector.vignetting / 2;
  return {
      calibration ? calibration->tone() : optics::ProjectorTone(),
      {projector.gamma, {0, 0, side, 0, side}, experiment.arena_width, experiment.arena_height}};
}

}  // namespace lab::sim
