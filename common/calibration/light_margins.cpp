#include "common/calibration/light_margins.hpp"

namespace lab {

LightCalibration toCalibration(const calibration::LightFit& fit, const Experiment& experiment) {
  LightCalibration calibration;
  calibration.gamma = fit.gamma;
  calibration.vignetting = fit.vignetting;
  calibration.scale = fit.scale;
  calibration.ambient = fit.ambient;
  calibration.residual = fit.residual;
  calibration.arena_width = experiment.arena_width;
  calibration.arena_height = experiment.arena_height;
  for (const auto& [sensor, gain] : fit.gains) {
    SensorGains& gains = calibration.gains[sensor.robot];
    (sensor.front ? gains.front : gains.back) = gain;
  }
  return calibration;
}

calibration::LightFit toFit(const LightCalibration& calibration) {
  calibration::LightFit fit;
  fit.gamma = calibration.gamma;
  fit.vignetting = calibration.vignetting;
  fit.scale = calibration.scale;
  fit.ambient = calibration.ambient;
  fit.residual = calibration.residual;
  for (const auto& [robot, gains] : calibration.gains) {
    fit.gains[{robot, true}] = gains.front;
    fit.gains[{robot, false}] = gains.back;
  }
  return fit;
}

std::vector<calibration::BandMargin> lightMargins(const LightCalibration& calibration,
                                                  const Experiment& experiment) {
  std::vector<calibration::BandLimits> bands;
  for (const LightBand& band : experiment.light_table.bands) {
    bands.push_back({band.program, band.low, band.high});
  }
  return calibration::bandMargins(toFit(calibration), bands, experiment.arena_width,
                                  experiment.arena_height);
}

}  // namespace lab
