/// How surely a light selects the program that it should.
#pragma once

#include <string>
#include <vector>

#include "light/photometry/light_fit.hpp"

namespace lab::calibration {

struct BandLimits {
  std::string program;
  double low = 0;   ///< [1] of the light
  double high = 0;  ///< [1]
};

/// What the middle of a band would come to at one place without the calibration.
struct PlaceMargin {
  optics::Place place;
  double reading = 0;  ///< [1] of the sensor that is nearest to leaving the band, or farthest out
  double chance = 0;   ///< [1] that one of its readings falls outside the band
};

/// For the light in the middle of a band.
struct BandMargin {
  std::string program;
  double light = 0;   ///< [1] the middle
  double margin = 0;  ///< [1] of the light, to the nearer edge
  double sigmas = 0;  ///< the same, in residuals of the least sensitive sensor
  double chance = 0;  ///< [1] that one reading falls outside the band
  // Without the calibration in force, at the worst place for the worst sensor:
  double plain_light = 0;  ///< [1] what it reads there
  optics::Place plain_place;
  SensorName plain_sensor;
  bool plain_right = false;  ///< it is still inside the band

  std::vector<PlaceMargin> places;  ///< row by row from y = 0, kMarginColumns x kMarginRows
};

/// Places over the arena, in the middles of equal fields.
inline constexpr int kMarginColumns = 6;
inline constexpr int kMarginRows = 4;

/// @param width,height of the arena [m]
[[nodiscard]] std::vector<BandMargin> bandMargins(const LightFit& fit,
                                                  const std::vector<BandLimits>& bands,
                                                  double width, double height);

}  // namespace lab::calibration
