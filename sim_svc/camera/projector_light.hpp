/// Errors of the simulated projector: differences between commanded and projected light.
#pragma once

#include <filesystem>

#include "common/experiment/experiment.hpp"
#include "light/optics/simulated_projector.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::sim {

/// The geometric difference between the calibration that projector_ctl uses and the simulated
/// projector of the experiment. With a real display there is no simulated projector, and the result
/// is the identity.
/// @param directory that the calibration's path is relative to
/// @throws ExperimentError if the calibration cannot be used.
[[nodiscard]] optics::ProjectorWarp projectorWarpOf(const Experiment& experiment,
                                                    const std::filesystem::path& directory);

/// The photometric difference: the light calibration that projector_ctl uses, and gamma and
/// vignetting of the simulated projector of the experiment. The identity with a real display.
/// @param directory that the calibration's path is relative to
/// @throws ExperimentError if the calibration cannot be used.
[[nodiscard]] optics::ProjectorTones projectorTonesOf(const Experiment& experiment,
                                                      const std::filesystem::path& directory);

}  // namespace lab::sim
