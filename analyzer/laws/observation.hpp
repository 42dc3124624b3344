#pragma once

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// How a camera sees a motion.
struct Observation {
  double exposure = 0;     ///< s: a position is the mean over it, so is a heading. 0: an instant.
  double sigma = 0;        ///< Localisation noise per axis, m.
  double sigma_theta = 0;  ///< Of the heading, rad.
};

/// The MSD of a law as a camera sees it, m^2: exact for stationary increments. With E the exposure
/// and M the law's MSD
///   int_0^E (E - w) / E^2 [M(tau + w) + M(|tau - w|) - 2 M(w)] dw + 4 sigma^2.
/// nan without a law.
[[nodiscard]] double observedMsd(const ExactLaw& law, const Observation& observation, double tau);

/// The same of the angular MSD, + 2 sigma_theta^2, rad^2.
[[nodiscard]] double observedAngularMsd(const ExactLaw& law, const Observation& observation,
                                        double tau);

}  // namespace lab::analysis
