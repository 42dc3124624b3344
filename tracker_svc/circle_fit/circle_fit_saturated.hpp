/// Circles on white that is brighter than the camera can say. Internal to the circle fit.
#pragma once

#include "tracker_svc/circle_fit/circle_fit_model.hpp"

namespace lab::detector::fit {

/// Where much of the window is full: a white level [DN] above black that explains how much, at the
/// place and with the blur of `disc`, with the size and the share of dark that are expected, and
/// that share. Elsewhere nothing is changed: the fit finds them by itself.
///
/// Full pixels do not count in a fit, so nothing holds its white level but the slope of the
/// outline, which asks for a start on the right side of full.
/// @param window whose light is written over
void startSaturated(Window& window, const Constants& constants, Disc& disc);

}  // namespace lab::detector::fit
