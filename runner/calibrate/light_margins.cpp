#include "runner/calibrate/light_margins.hpp"

#include <fmt/format.h>

#include "common/calibration/light_margins.hpp"
#include "common/math/units.hpp"

namespace lab::runner {

using units::kCm;

std::string marginLines(const LightCalibration& calibration, const Experiment& experiment) {
  std::string lines;
  for (const calibration::BandMargin& band : lightMargins(calibration, experiment)) {
    lines += fmt::format(
        "{}: light {:.3f} is {:.3f} from the edge of its band, {:.0f} standard deviations of a "
        "reading; probability of a wrong reading {:.1e}. Without the calibration the {} sensor of "
        "robot {} would read {:.3f} at ({:.0f}, {:.0f}) cm, {} the band\n",
        band.program, band.light, band.margin, band.sigmas, band.chance,
        band.plain_sensor.front ? "front" : "back", band.plain_sensor.robot, band.plain_light,
        kCm * band.plain_place.x, kCm * band.plain_place.y,
        band.plain_right ? "inside" : "outside");
  }
  return lines;
}

}  // namespace lab::runner
