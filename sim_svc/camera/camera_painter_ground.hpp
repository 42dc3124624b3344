/// What stands still in the simulated camera's picture: which place of the floor each cell sees,
/// and the colours of floor and walls.
#pragma once

#include <vector>

#include "light/optics/camera_model.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// Floor and walls of all cells.
struct Ground {
  std::vector<float> x;       ///< [m] the place on the floor
  std::vector<float> y;       ///< [m]
  std::vector<float> albedo;  ///< [1]

  Ground(const PainterSettings& settings, const Lattice& lattice, const optics::CameraModel& model);
};

/// The pixels that see any of a disc of this radius around (x, y, z) [m].
[[nodiscard]] Box pixelsAround(const optics::CameraModel& model, double x, double y, double z,
                               double radius);

/// Side of a cell on the floor at (x, y) [m].
[[nodiscard]] double cellSize(const optics::CameraModel& model, double x, double y);

}  // namespace lab::sim::painter
