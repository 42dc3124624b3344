/// Computes the points of the commanded field that light the cells of the simulated camera.
#pragma once

#include <vector>

#include "light/optics/simulated_projector.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera/camera_painter_ground.hpp"
#include "sim_svc/camera/camera_painter_light.hpp"

namespace lab::sim::painter {

/// The points for a projector that differs from its calibration. They are computed once, exactly on
/// every second pixel and linearly interpolated between.
class WarpedPlaces {
 public:
  /// @param shift maps the ground's points to the height at which light is commanded
  WarpedPlaces(const PainterSettings& settings, const Lattice& lattice, const Ground& ground,
               const PlaneShift& shift);

  [[nodiscard]] LitPlaces view() const { return {x_.data(), y_.data(), {}, lit_.data()}; }

 private:
  std::vector<float> x_;    ///< [m]
  std::vector<float> y_;    ///< [m]
  std::vector<float> lit_;  ///< [1] share of a cell inside the projector's picture
};

}  // namespace lab::sim::painter
