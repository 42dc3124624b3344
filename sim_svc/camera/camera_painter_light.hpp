/// Computes the projector's light in the cells of the simulated camera.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "light/field/field.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// x' = scale x + x0, y' = scale y + y0: maps a point on the floor to the intersection of another
/// height with the line from this point to a fixed far point.
struct PlaneShift {
  double scale = 1;
  double x0 = 0;
  double y0 = 0;

  /// The map towards the point `far` = (x, y, z) [m], from the height `from` to `height`.
  [[nodiscard]] static PlaneShift towards(const std::array<double, 3>& far, double height,
                                          double from = 0) {
    const double share = (height - from) / (far[2] - from);
    return {1 - share, share * far[0], share * far[1]};
  }
};

/// The point of the light field that lights each cell of a lattice.
struct LitPlaces {
  const float* x = nullptr;    ///< [m]
  const float* y = nullptr;    ///< [m]
  PlaneShift shift;            ///< maps (x, y) to the field
  const float* lit = nullptr;  ///< [1] share of the cell inside the projector's picture; null: the
                               ///< picture covers the arena and a little more
};

/// A list of layers as a projector shows it: edges have the softness of its lens, and there is no
/// light outside its picture.
class Projection {
 public:
  Projection() = default;

  /// @param cell [m] side of a cell on the floor; sharper edges would show the pattern of the cells
  Projection(const std::vector<light::Layer>& layers, const PainterSettings& settings, double cell);

  /// Computes the light of these cells of the lattice (whole pixels).
  void light(const Lattice& lattice, const LitPlaces& places, const Box& cells,
             std::vector<float>& out) const;

  /// The tiles where light() differs from that of `before` with the same places, in pixels counted
  /// from the lattice's first cell.
  [[nodiscard]] std::vector<Box> changed(const Projection& before, const Lattice& lattice,
                                         const LitPlaces& places) const;

 private:
  /// A part of the picture, small enough that few layers have an edge in it.
  struct Tile {
    Box pixels;                       ///< counted from the lattice's first cell
    Box around;                       ///< with one more pixel on each side, inside the lattice
    double x = 0, y = 0, radius = 0;  ///< [m] a disk in the field that contains `around`
  };

  [[nodiscard]] static Tile tile(const Lattice& lattice, const LitPlaces& places,
                                 const Box& pixels);
  [[nodiscard]] light::CompiledLayers layersOf(const Tile& tile) const {
    return layers_.within({tile.x, tile.y, tile.radius});
  }
  [[nodiscard]] double marginInside(const LitPlaces& places, double x, double y) const;
  void paint(const light::CompiledLayers& layers, const Tile& tile, const Lattice& lattice,
             const LitPlaces& places, std::vector<float>& out) const;

  void tone(const Lattice& lattice, const LitPlaces& places, const Box& cells,
            std::vector<float>& out) const;

  light::CompiledLayers layers_;
  double width_ = 0;
  double height_ = 0;
  std::shared_ptr<const optics::ToneTable> tones_;  ///< null: no errors of brightness
};

}  // namespace lab::sim::painter
