#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/bootstrap/film_reference.hpp"
#include "analyzer/curves/curves.hpp"

namespace lab::analysis {

/// The heading noise in the angular MSD [rad^2] of a curve whose shape without noise is known, from
/// the first lag and another one; its error may make it negative. 0 if it cannot be determined.
/// @param angular the curve with its noise, shape the curve without noise, by lag
/// @param second index of the other lag
[[nodiscard]] double headingOffset(const std::vector<double>& angular,
                                   const std::vector<double>& shape, std::size_t second);

/// The second lag with which headingOffset() scatters least over the films: the motion at both lags
/// must fluctuate together, which depends on how long holds are.
[[nodiscard]] std::size_t secondLag(const FilmReference& films);

/// Judges measured curves of a program by simulated films of it (Law::isSimulated): fills `exact`
/// with the expected curves, and z.
///
/// Mean squares are compared by their cube roots, which are nearly normal. Measured and simulated
/// curves are treated alike: noise is removed, and if the MSD at its most precise lag is within 5 %
/// of the expected one, a speed is taken to be calibrated wrongly by up to 2.5 %, and all lags are
/// relative to that one. z is divided by the factor by which the largest |z| of the films exceeds
/// 3.2 in 1 % of them, or 3.8 in 0.25 %, if it does: so the verdict (judge()) has the same rate of
/// false alarms whatever the distribution is.
/// @param result of curves() for the same data
/// @param films complete
void compareWithFilms(Curves& result, const FilmReference& films, const ProgramLaw& law,
                      const BlockData& data, const CurveOptions& options);

}  // namespace lab::analysis
