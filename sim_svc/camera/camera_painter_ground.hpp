/// The static part of the simulated camera's picture: the point on the floor that each cell shows,
/// and the albedo of floor and walls.
#pragma once

#include <vector>

#include "light/optics/camera_model.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// Floor and walls, per cell.
struct Ground {
  std::vector<float> x;       ///< [m] point on the floor
  std::vector<float> y;       ///< [m]
  std::vector<float> albedo;  ///< [1]

  Ground(const PainterSettings& settings, const Lattice& lattice, const optics::CameraModel& model);
};

/// The pixels that show any part of a disc of this radius around (x, y, z) [m].
[[nodiscard]] Box pixelsAround(const optics::CameraModel& model, double x, double y, double z,
                               double radius);

/// Side length of a cell on the floor at (x, y) [m].
[[nodiscard]] double cellSize(const optics::CameraModel& model, double x, double y);

}  // namespace lab::sim::painter
