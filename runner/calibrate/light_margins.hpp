/// Describes the effect of a light calibration on the light bands of an experiment.
#pragma once

#include <string>

#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// One line per band: the distance of the light in its middle from the edge of the band, the
/// probability of a wrong reading, and the reading of the worst sensor at the worst place without
/// the calibration.
[[nodiscard]] std::string marginLines(const LightCalibration& calibration,
                                      const Experiment& experiment);

}  // namespace lab::runner
