/// Model-independent check that a circle is darker inside than outside, all around. Internal to the
/// circle fit.
#pragma once

#include "tracker_svc/circle_fit/circle_fit_model.hpp"

namespace lab::detector::fit {

/// Whether in five of eight sectors the pixels just inside the outline return much less of the
/// light (window.light, of the last fit) than those just outside, the middle is dark, and hardly
/// any pixel outside is dark.
/// @param disc only its place, scale and blur are used
/// @param noise residuals over the expected noise
bool darkAllAround(const Window& window, const Constants& constants, const Disc& disc, float noise);

/// Whether the pixels in the middle of the window are clearly darker than those around the circle,
/// in any light: a cheap check before an edge model is tried.
bool darkInside(const Window& window, const Constants& constants, float sigma);

}  // namespace lab::detector::fit
