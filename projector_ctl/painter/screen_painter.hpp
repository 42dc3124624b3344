/// Renders the light field into the pixels of a projector.
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

/// Paints frames; each pixel gets the light at the point of the arena that its centre falls on. The
/// picture is divided into tiles: in a tile only the layers with an edge there are evaluated, and a
/// tile whose layers have not changed is not painted again.
class ScreenPainter {
 public:
  static constexpr int kTile = 32;  ///< [px]

  /// @param model its columns and rows are the size of the picture. Pixels that do not fall onto
  ///   the arena stay dark.
  /// @param tone null: the identity
  explicit ScreenPainter(const optics::ProjectorModel& model,
                         std::shared_ptr<const Tone> tone = nullptr);

  /// Paints `field`, whose layers must pass validate().
  /// @return the parts that changed since the last call, at first the whole picture; valid until
  ///   the next call
  std::span<const Box> paint(const light::Field& field);

  [[nodiscard]] optics::GreyView picture() const { return picture_.view(); }

  /// The picture, for drawing over the light.
  [[nodiscard]] optics::GreyImage& canvas() { return picture_; }

  /// Repaints the tiles that `box` touches in the next frame, e.g. where canvas() was drawn on.
  void forget(const Box& box);

 private:
  struct Tile {
    Box box;
    light::Disk disk;      ///< contains the positions of all its pixels
    bool lit = false;      ///< at least one pixel falls onto the arena
    bool gaps = false;     ///< at least one pixel does not
    bool painted = false;  ///< the tile shows `shown`
    light::CompiledField shown;
  };
  /// Neighbouring tiles, so that most layers can be excluded for all of them at once.
  struct Block {
    light::Disk disk;
    std::vector<Tile> tiles;
  };

  void mapPlaces(const optics::ProjectorModel& model);
  [[nodiscard]] Tile tileAt(const Box& box);
  [[nodiscard]] static light::Disk around(const std::vector<Tile>& tiles);
  void placesOf(const Tile& tile);
  void paint(Tile& tile);
  void noteChanged(const Box& box);

  std::shared_ptr<const Tone> tone_;
  optics::GreyImage picture_;
  bool straight_;  ///< x depends only on the column and y only on the row
  std::vector<double> x_,
      y_;  ///< [m] per column and row if straight_, else per pixel; NaN: not on the arena
  std::vector<Block> blocks_;
  std::vector<Box> changed_;
  std::vector<double> tile_x_, tile_y_, tile_light_;
};

}  // namespace lab::projector
