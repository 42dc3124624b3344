#pragma once

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// Blur and noise of a camera.
struct MeasurementModel {
  double exposure = 0;  ///< [s] positions and headings are means over this time; 0: instantaneous
  double sigma = 0;     ///< [m] standard deviation of the localisation noise per axis
  double sigma_theta = 0;  ///< [rad] standard deviation of the noise of the heading
};

/// The MSD of a law as observed by a camera [m^2]. Exact for stationary increments. With E the
/// exposure and M the law's MSD
///   int_0^E (E - w) / E^2 [M(tau + w) + M(|tau - w|) - 2 M(w)] dw + 4 sigma^2.
/// nan if the law does not exist.
[[nodiscard]] double observedMsd(const ExactLaw& law, const MeasurementModel& model, double tau);

/// The same for the angular MSD, with 2 sigma_theta^2 in place of 4 sigma^2 [rad^2].
[[nodiscard]] double observedAngularMsd(const ExactLaw& law, const MeasurementModel& model,
                                        double tau);

}  // namespace lab::analysis
