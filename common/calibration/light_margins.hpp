/// A fit of the light calibration as a file and back, and the margins of an experiment's light
/// bands.
#pragma once

#include <vector>

#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment.hpp"
#include "light/photometry/light_fit.hpp"
#include "light/photometry/light_margin.hpp"

namespace lab {

/// The fit as the calibration that is written to a file. The arena is that of the experiment.
[[nodiscard]] LightCalibration toCalibration(const calibration::LightFit& fit,
                                             const Experiment& experiment);

/// The inverse of toCalibration().
[[nodiscard]] calibration::LightFit toFit(const LightCalibration& calibration);

/// How surely the light selects the intended program: one margin per band of the experiment's light
/// table.
[[nodiscard]] std::vector<calibration::BandMargin> lightMargins(const LightCalibration& calibration,
                                                                const Experiment& experiment);

}  // namespace lab
