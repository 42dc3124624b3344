/// What the simulated projector makes of the light that is wanted.
#pragma once

#include <filesystem>

#include "common/experiment/experiment.hpp"
#include "light/optics/simulated_projector.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::sim {

/// Between the calibration that projector_ctl goes by and what the experiment says the simulated
/// projector is. A real display's projector is not simulated: its light is where it is wanted.
/// @param directory that the calibration's path is relative to
/// @throws ExperimentError when the calibration cannot be used.
[[nodiscard]] optics::ProjectorWarp projectorWarpOf(const Experiment& experiment,
                                                    const std::filesystem::path& directory);

/// As projectorWarpOf(): the calibration of light, and what the experiment says.
[[nodiscard]] optics::ProjectorTones tonesOf(const Experiment& experiment,
                                             const std::filesystem::path& directory);

}  // namespace lab::sim
