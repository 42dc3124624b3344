/// What the simulated projector makes of the light that is wanted.
#pragma once

#include <filesystem>

#include "common/experiment.hpp"
#include "optics/projector_tone.hpp"
#include "optics/simulated_projector.hpp"

namespace lab::sim {

/// Between the calibration that projector_ctl goes by and what the experiment says the simulated
/// projector is. A real display's projector is not simulated: its light is where it is wanted.
/// @param directory that the calibration's path is relative to
/// @throws ExperimentError when the calibration cannot be used.
[[nodiscard]] optics::Bending bendingOf(const Experiment& experiment,
                                        const std::filesystem::path& directory);

/// How bright a simulated projector is, beside how bright it is believed to be.
struct ProjectorTones {
  optics::ProjectorTone believed;
  optics::ProjectorTone real;

  /// What falls on `place` where `intensity` was wanted at `source`.
  [[nodiscard]] double light(double intensity, optics::Place source, optics::Place place) const {
    if (believed.isPlain() && real.isPlain()) return intensity;
    return real.light(believed.value(intensity, source), place);
  }
};

/// As bendingOf(): the calibration of light, and what the experiment says.
[[nodiscard]] ProjectorTones tonesOf(const Experiment& experiment,
                                     const std::filesystem::path& directory);

}  // namespace lab::sim
