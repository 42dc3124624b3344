/// The projector's light in the cells of the simulated camera.
#pragma once

#include <array>
#include <vector>

#include "light/field.hpp"
#include "sim_svc/camera_painter.hpp"
#include "sim_svc/camera_painter_cells.hpp"

namespace lab::sim::painter {

struct Ground;

/// x' = scale x + x0, y' = scale y + y0: where a line through a floor point and a far point crosses
/// another height.
struct PlaneShift {
  double scale = 1;
  double x0 = 0;
  double y0 = 0;

  /// Towards `far` = (x, y, z) [m], from the floor up to `height`.
  [[nodiscard]] static PlaneShift towards(const std::array<double, 3>& far, double height) {
    const double share = height / far[2];
    return {1 - share, share * far[0], share * far[1]};
  }
};

/// A list of layers as a projector shows it: no edge sharper than its lens, nothing outside its
/// picture.
class Projection {
 public:
  Projection() = default;

  /// @param cell [m] side of a cell on the floor: an edge thinner than that would leave its pattern
  Projection(const std::vector<light::Layer>& layers, const PainterSettings& settings, double cell);

  /// The light of these cells of the lattice (whole pixels), where `shift` takes their floor
  /// points.
  void light(const Lattice& lattice, const Ground& ground, const PlaneShift& shift,
             const Box& cells, std::vector<float>& out) const;

 private:
  /// A part of the picture, small enough that few layers have an edge in it.
  struct Tile {
    Box pixels;                       ///< counted from the lattice's first cell
    Box around;                       ///< one more to each side, as far as there are any
    double x = 0, y = 0, radius = 0;  ///< [m] a disc in the field that holds it all
  };

  [[nodiscard]] Tile tile(const Lattice& lattice, const Ground& ground, const PlaneShift& shift,
                          const Box& pixels) const;
  [[nodiscard]] light::CompiledLayers layersOf(const Tile& tile) const;
  [[nodiscard]] double insideBy(double x, double y) const;
  void paint(const light::CompiledLayers& layers, const Tile& tile, const Lattice& lattice,
             const Ground& ground, const PlaneShift& shift, std::vector<float>& out) const;

  std::vector<light::Layer> layers_;
  double width_ = 0;
  double height_ = 0;
};

}  // namespace lab::sim::painter
