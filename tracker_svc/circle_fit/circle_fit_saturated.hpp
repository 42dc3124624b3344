/// Circles on white that saturates the camera. Internal to the circle fit.
#pragma once

#include "tracker_svc/circle_fit/circle_fit_model.hpp"

namespace lab::detector::fit {

/// If much of the window is saturated: a start with the white level [DN above black] that explains
/// the saturated share, at the place and with the blur of `disc`, with the expected size and dark
/// ratio. Otherwise the disc is unchanged.
///
/// Saturated pixels do not count in a fit. Only the slope of the outline then determines the
/// white level, which requires a start above saturation.
/// @param window its light is overwritten
void startSaturated(Window& window, const Constants& constants, Disc& disc);

}  // namespace lab::detector::fit
