/// Finds and fits the light edges that cross a circle, or light that bends on it. Internal to the
/// circle fit.
#pragma once

#include <optional>

#include "tracker_svc/circle_fit/circle_fit_plain.hpp"

namespace lab::detector::fit {

/// Where the circle near `start` is, as a point of the grid, in light that is no plane.
/// @param outcome the fit from there
std::optional<GridPoint> settleLit(const Task& task, GridPoint start, Window& window,
                                   Outcome& outcome);

/// Whether the white around the circle leaves room for a light edge: a look that costs a tenth of a
/// fit with one.
/// @param plain the fit without edges, `window` as it left it
/// @param sound it has the disc right: what it does not believe lies beside the circle, as a dot on
///   the cap does, and leads to no edge
bool edgeMayCross(const Task& task, const Outcome& plain, bool sound, const Window& window);

}  // namespace lab::detector::fit
