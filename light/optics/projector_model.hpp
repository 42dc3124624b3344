/// Maps a projector's pixels to the places they light at sensor height, and back.
#pragma once

#include <optional>

#include "light/optics/camera_model.hpp"

namespace lab::optics {

/// A projector is an inverse camera: its lens maps places to pixels as in CameraModel. Without a
/// calibration the arena fills the picture: x to the right, y up, column 0 begins at x = 0 and row
/// 0, the top one, at y = height.
class ProjectorModel {
 public:
  /// The arena of width x height [m] fills a picture of columns x rows pixels.
  ProjectorModel(double width, double height, int columns, int rows);

  /// @param lens calibrated; its width and height are the picture's
  /// @param height [m] above the floor, of the places: that of the light sensors
  ProjectorModel(const CameraParameters& lens, double height);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] bool isNominal() const { return !lens_; }

  /// Centre of pixel (i, j) is {i, j}; outside the picture for places that are not lit.
  [[nodiscard]] Pixel pixelOf(Place place) const;

  /// Empty if the lens model cannot be inverted.
  [[nodiscard]] std::optional<Place> placeOf(Pixel pixel) const;

 private:
  std::optional<CameraModel> lens_;
  double width_ = 0;          ///< [m] of the arena, nominal
  double height_ = 0;         ///< [m]
  double sensor_height_ = 0;  ///< [m]
  int columns_ = 0;
  int rows_ = 0;
};

}  // namespace lab::optics
