/// Finds and fits the light edges that cross a circle. Internal to the circle fit.
#pragma once

#include <optional>

#include "tracker_svc/circle_fit_plain.hpp"

namespace lab::tracker::fit {

/// Where the circle near `start` is, as a point of the grid, with light edges considered.
/// @param outcome the fit from there
std::optional<GridPoint> settleLit(const Task& task, GridPoint start, Window& window,
                                   Outcome& outcome);

}  // namespace lab::tracker::fit
