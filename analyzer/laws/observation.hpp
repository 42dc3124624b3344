#pragma once

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// Blur and noise of a camera.
struct Observation {
  double exposure = 0;  ///< Positions and headings are means over this time, s; 0: instantaneous.
  double sigma = 0;     ///< Localisation noise per axis, m.
  double sigma_theta = 0;  ///< Noise of the heading, rad.
};

/// The MSD of a law as observed by a camera, m^2. Exact for stationary increments. With E the
/// exposure and M the law's MSD
///   int_0^E (E - w) / E^2 [M(tau + w) + M(|tau - w|) - 2 M(w)] dw + 4 sigma^2.
/// nan if the law does not exist.
[[nodiscard]] double observedMsd(const ExactLaw& law, const Observation& observation, double tau);

/// The same for the angular MSD, with 2 sigma_theta^2 in place of 4 sigma^2; rad^2.
[[nodiscard]] double observedAngularMsd(const ExactLaw& law, const Observation& observation,
                                        double tau);

}  // namespace lab::analysis
