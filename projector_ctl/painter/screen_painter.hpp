/// The light field in the pixels of a projector: numbers in, a picture out, no display.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "light/field/field.hpp"
#include "light/optics/grey_image.hpp"
#include "light/optics/projector_model.hpp"
#include "projector_ctl/painter/box.hpp"
#include "projector_ctl/painter/tone.hpp"

namespace lab::projector {

/// Paints frame after frame, each pixel with the light at the place its centre falls on. The
/// picture is cut in tiles: in a tile only the layers with an edge there are evaluated, and a tile
/// whose layers are those of the frame before is left alone.
class ScreenPainter {
 public:
  static constexpr int kTile = 32;  ///< [px]

  /// @param model its columns and rows are the picture's. Pixels without a place stay dark.
  /// @param tone null: the identity
  explicit ScreenPainter(const optics::ProjectorModel& model,
                         std::shared_ptr<const Tone> tone = nullptr);

  /// Paints `field`, whose layers pass validate().
  /// @return what changed since the last call, the whole picture at first; valid until the next.
  std::span<const Box> paint(const light::Field& field);

  [[nodiscard]] optics::GreyView picture() const { return picture_.view(); }

  /// For what is drawn over the light: the tiles that `box` touches are painted anew in the next
  /// frame.
  [[nodiscard]] optics::GreyImage& canvas() { return picture_; }
  void forget(const Box& box);

 private:
  struct Tile {
    Box box;
    light::Disc disc;      ///< holds the places of all its pixels
    bool lit = false;      ///< any of them
    bool gaps = false;     ///< but not all of them
    bool painted = false;  ///< with `shown`
    light::CompiledField shown;
  };
  /// Tiles that lie together, so that most layers are out of sight for all of them at once.
  struct Block {
    light::Disc disc;
    std::vector<Tile> tiles;
  };

  void mapPlaces(const optics::ProjectorModel& model);
  [[nodiscard]] Tile tileAt(const Box& box);
  [[nodiscard]] static light::Disc around(const std::vector<Tile>& tiles);
  void placesOf(const Tile& tile);
  void paint(Tile& tile);
  void noteChanged(const Box& box);

  std::shared_ptr<const Tone> tone_;
  optics::GreyImage picture_;
  bool straight_;  ///< x depends on the column alone and y on the row alone
  std::vector<double> x_,
      y_;  ///< [m] of the columns and rows, or else of all pixels; NaN: no place
  std::vector<Block> blocks_;
  std::vector<Box> changed_;
  std::vector<double> tile_x_, tile_y_, tile_light_;
};

}  // namespace lab::projector
