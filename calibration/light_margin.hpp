/// How surely a light selects the program that it should.
#pragma once

#include <string>
#include <vector>

#include "calibration/light_fit.hpp"

namespace lab::calibration {

struct BandLimits {
  std::string program;
  double low = 0;   ///< [1] of the light
  double high = 0;  ///< [1]
};

/// For the light in the middle of a band.
struct BandMargin {
  std::string program;
  double light = 0;    ///< [1] the middle
  double margin = 0;   ///< [1] of the light, to the nearer edge
  double sigmas = 0;   ///< the same, in residuals of the least sensitive sensor
  double chance = 0;   ///< [1] that one reading falls outside the band
  // Without the calibration in force, at the worst place for the worst sensor:
  double plain_light = 0;   ///< [1] what it reads there
  optics::Place plain_place;
  SensorName plain_sensor;
  bool plain_right = false;  ///< it is still inside the band
};

/// @param width,height of the arena [m]
[[nodiscard]] std::vector<BandMargin> bandMargins(const LightFit& fit,
                                                  const std::vector<BandLimits>& bands,
                                                  double width, double height);

}  // namespace lab::calibration
