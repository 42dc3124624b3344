/// Rasterises the light field.
#pragma once

#include <cstdint>
#include <vector>

#include "light/field/field.hpp"

namespace lab::light {

/// Intensities at the centres of nx x ny equal pixels over the arena. Row 0 is at the smallest y:
/// at(i, j) is the light at x = (i + 1/2) width / nx, y = (j + 1/2) height / ny.
struct Raster {
  int nx = 0;
  int ny = 0;
  std::vector<float> values;  ///< ny rows of nx intensities in 0..1

  [[nodiscard]] float at(int i, int j) const {
    return values[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) +
                  static_cast<std::size_t>(i)];
  }
};

/// Number of pixels of a picture.
struct PictureSize {
  int nx = 1;
  int ny = 1;
};

/// A picture of the arena that is `nx` pixels wide, in the arena's proportions. It is at most twice
/// as high as `nx`: a narrower arena has fewer columns.
[[nodiscard]] PictureSize pictureSize(double width, double height, int nx);

/// @param width,height of the arena [m].
/// @throws std::invalid_argument if a number of pixels is below 1 or a length is not positive
[[nodiscard]] Raster rasterise(const CompiledField& field, double width, double height, int nx,
                               int ny);
[[nodiscard]] Raster rasterise(const Field& field, double width, double height, int nx, int ny);

/// Eight-bit grey, 0 dark .. 255 white, rounded to the nearest, as a picture: the top row, at the
/// largest y, first.
[[nodiscard]] std::vector<std::uint8_t> toGrey(const Raster& raster);

/// The raster as a grey PNG file, oriented like a plot: x right, y up.
[[nodiscard]] std::vector<std::uint8_t> toPng(const Raster& raster);

/// Rasterises fields for a display frame by frame. Keeps the rasters of both ends of a cross-fade,
/// so that a frame of a ramp costs one mix per pixel, whatever the number of layers.
class FramePainter {
 public:
  /// @param width,height of the arena [m], @param nx,ny of the display, as for rasterise().
  FramePainter(double width, double height, int nx, int ny);

  /// The raster of `field`, valid until the next call.
  const Raster& paint(const Field& field);

 private:
  struct End {
    std::vector<Layer> layers;
    Raster raster;
  };

  void refresh(End& end, const std::vector<Layer>& layers);

  double width_, height_;
  End layers_;
  End previous_;
  Raster mixed_;
};

}  // namespace lab::light
