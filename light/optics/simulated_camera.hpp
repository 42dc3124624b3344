/// The camera over the simulated arena.
#pragma once

#include "light/optics/camera_model.hpp"

namespace lab::optics {

/// A camera 1.72 m above the floor of an arena of width x height [m], not quite above its middle
/// and not quite level, with a lens of some distortion (k1 = -0.12): pictures of columns x rows
/// pixels in which the whole arena, caps at 5 cm height included, is seen.
[[nodiscard]] CameraParameters simulatedCamera(int columns, int rows, double width, double height);

}  // namespace lab::optics
