/// Parameters of the simulated camera above the arena.
#pragma once

#include "light/optics/camera_model.hpp"

namespace lab::optics {

/// A camera 1.72 m above the floor of an arena of width x height [m], slightly off its middle and
/// slightly tilted, with some distortion (k1 = -0.12). Pictures of columns x rows pixels show the
/// whole arena, including caps at 5 cm height.
[[nodiscard]] CameraParameters simulatedCamera(int columns, int rows, double width, double height);

/// The same camera above a part of the arena with its lower left corner in (x, y) [m].
[[nodiscard]] CameraParameters simulatedCameraAbove(int columns, int rows, double x, double y,
                                                    double width, double height);

/// The camera moved by (x, y) [m] along the floor.
[[nodiscard]] CameraParameters movedCamera(CameraParameters camera, double x, double y);

}  // namespace lab::optics
