/// Safety margins of the light bands that select programs.
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

/// At one place, the light in the middle of a band without the calibration.
struct PlaceMargin {
  optics::Place place;
  double reading = 0;  ///< [1] of the sensor closest to leaving the band, or farthest outside
  double chance = 0;   ///< [1] probability that one of its readings is outside the band
};

/// Margins of the light in the middle of a band.
struct BandMargin {
  std::string program;
  double light = 0;   ///< [1] the middle
  double margin = 0;  ///< [1] of the light, to the nearer edge
  double sigmas = 0;  ///< the margin in residuals of the least sensitive sensor
  double chance = 0;  ///< [1] probability that one reading is outside the band
  // Without the calibration, at the worst place for the worst sensor:
  double plain_light = 0;  ///< [1] its reading
  optics::Place plain_place;
  SensorName plain_sensor;
  bool plain_right = false;  ///< whether it is still inside the band

  std::vector<PlaceMargin> places;  ///< row by row from y = 0, kMarginColumns x kMarginRows
};

/// Grid of places over the arena: the centres of equal cells.
inline constexpr int kMarginColumns = 6;
inline constexpr int kMarginRows = 4;

/// @param width,height of the arena [m]
[[nodiscard]] std::vector<BandMargin> bandMargins(const LightFit& fit,
                                                  const std::vector<BandLimits>& bands,
                                                  double width, double height);

}  // namespace lab::calibration
