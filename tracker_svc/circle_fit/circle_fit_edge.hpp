/// Finds and fits light edges that cross a circle, or a light gradient on it. Internal to the
/// circle fit.
#pragma once

#include <optional>

#include "tracker_svc/circle_fit/circle_fit_plain.hpp"

namespace lab::detector::fit {

/// Fits the circle near `start` in uneven light.
/// @return the grid point of its centre
/// @param outcome receives the fit from there
std::optional<GridPoint> settleLit(const Task& task, GridPoint start, Window& window,
                                   Outcome& outcome);

/// Whether the white around the circle shows a light edge. Costs a tenth of a fit with an edge.
/// @param plain the fit without edges, which left `window`
/// @param sound whether it fits the disc well: pixels with low weight then lie beside the circle,
///   as with a dot on the cap, and are no sign of an edge
bool edgeMayCross(const Task& task, const Outcome& plain, bool sound, const Window& window);

}  // namespace lab::detector::fit
