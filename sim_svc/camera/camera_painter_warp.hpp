/// The places of the commanded field that light the cells of the simulated camera.
#pragma once

#include <vector>

#include "light/optics/simulated_projector.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera/camera_painter_ground.hpp"
#include "sim_svc/camera/camera_painter_light.hpp"

namespace lab::sim::painter {

/// Of a projector that is not what it is believed to be: worked out once, exact on every second
/// pixel and straight between.
class WarpedPlaces {
 public:
  /// @param shift takes the ground's points to where light is meant
  WarpedPlaces(const PainterSettings& settings, const Lattice& lattice, const Ground& ground,
               const PlaneShift& shift);

  [[nodiscard]] LitPlaces view() const { return {x_.data(), y_.data(), {}, lit_.data()}; }

 private:
  std::vector<float> x_;    ///< [m]
  std::vector<float> y_;    ///< [m]
  std::vector<float> lit_;  ///< [1] share of a cell that the picture reaches
};

}  // namespace lab::sim::painter
