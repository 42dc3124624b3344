/// The projector's light in the cells of the simulated camera.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "light/field/field.hpp"
#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// x' = scale x + x0, y' = scale y + y0: where a line through a floor point and a far point crosses
/// another height.
struct PlaneShift {
  double scale = 1;
  double x0 = 0;
  double y0 = 0;

  /// Towards `far` = (x, y, z) [m], from the height `from` to `height`.
  [[nodiscard]] static PlaneShift towards(const std::array<double, 3>& far, double height,
                                          double from = 0) {
    const double share = (height - from) / (far[2] - from);
    return {1 - share, share * far[0], share * far[1]};
  }
};

/// Where the light of each cell of a lattice comes from in the field.
struct LitPlaces {
  const float* x = nullptr;    ///< [m]
  const float* y = nullptr;    ///< [m]
  PlaneShift shift;            ///< takes (x, y) to the field
  const float* lit = nullptr;  ///< [1] share that the picture reaches; null: all, and a little
                               ///< beyond the arena
};

/// A list of layers as a projector shows it: no edge sharper than its lens, nothing outside its
/// picture.
class Projection {
 public:
  Projection() = default;

  /// @param cell [m] side of a cell on the floor: an edge thinner than that would leave its pattern
  Projection(const std::vector<light::Layer>& layers, const PainterSettings& settings, double cell);

  /// The light of these cells of the lattice (whole pixels).
  void light(const Lattice& lattice, const LitPlaces& places, const Box& cells,
             std::vector<float>& out) const;

  /// Where light() of the whole lattice differs from that of `before`, with the same places: whole
  /// tiles, in pixels counted from the lattice's first cell.
  [[nodiscard]] std::vector<Box> changed(const Projection& before, const Lattice& lattice,
                                         const LitPlaces& places) const;

 private:
  /// A part of the picture, small enough that few layers have an edge in it.
  struct Tile {
    Box pixels;                       ///< counted from the lattice's first cell
    Box around;                       ///< one more to each side, as far as there are any
    double x = 0, y = 0, radius = 0;  ///< [m] a disc in the field that holds it all
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
  std::shared_ptr<const optics::ToneTable> tones_;  ///< null: light is as wanted
};

}  // namespace lab::sim::painter
