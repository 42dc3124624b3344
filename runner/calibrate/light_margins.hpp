/// What a calibration of light means for the bands of an experiment, in words.
#pragma once

#include <string>

#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// A line for each band: how far the light in its middle is from its edge, how probable a wrong
/// reading is, and what the worst sensor would read at the worst place without the calibration.
[[nodiscard]] std::string marginLines(const LightCalibration& calibration,
                                      const Experiment& experiment);

}  // namespace lab::runner
