/// The ground behind blobs: its brightness, its noise, and where blobs stand out from it.
#pragma once

#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::detector {

/// Columns first <= x <= last of a row.
struct ColumnSpan {
  int first = 0;
  int last = -1;
};

/// The columns of each row that show the rectangle 0..width, 0..height [m] of a plane.
[[nodiscard]] std::vector<ColumnSpan> columnsOf(const optics::CameraModel& camera, double width,
                                                double height, double plane);

/// Estimates the ground from a picture with blobs: medians of blocks of pixels without blobs,
/// linear between their centres. Blobs may cover two thirds of a block.
class BlobGround {
 public:
  /// @param block [px] side of a block
  BlobGround(const optics::Imaging& imaging, std::vector<ColumnSpan> columns, int block);

  /// @param bright whether blobs are brighter than the ground
  void estimate(const optics::GreyView& picture, bool bright);

  /// [DN] of the ground, rows of the picture's width; valid inside the columns.
  [[nodiscard]] const float* row(int y) const { return &ground_[at(y)]; }

  /// [DN] by how much the mean of 3 x 3 pixels stands out from the ground; 0 outside the columns.
  [[nodiscard]] const float* contrast(int y) const { return &contrast_[at(y)]; }

  /// [DN] contrast that noise does not reach, and a tenth of the ground's light.
  [[nodiscard]] float threshold(float ground) const;

  /// [DN^2] variance of a pixel of this brightness.
  [[nodiscard]] double variance(double grey) const;

  [[nodiscard]] const std::vector<ColumnSpan>& columns() const { return columns_; }
  [[nodiscard]] const optics::Imaging& imaging() const { return imaging_; }
  void setCompressed(bool compressed) { imaging_.compressed = compressed; }

 private:
  [[nodiscard]] std::size_t at(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }
  void measureNoise(const optics::GreyView& picture);
  void correctBlocks(const optics::GreyView& picture, bool bright, double quantile, bool masked);
  void interpolate();
  void standOut(const optics::GreyView& picture, bool bright);

  optics::Imaging imaging_;
  std::vector<ColumnSpan> columns_;
  int block_;
  int width_ = 0;
  int height_ = 0;
  double noise_ = 1;  ///< [1] measured variance over that of `imaging_`
  std::vector<float> ground_;
  std::vector<float> contrast_;
  std::vector<float> blocks_;    ///< [DN] of the ground, rows of blocks
  std::vector<int> histograms_;  ///< of the blocks, 256 counts each
  std::vector<float> rows_;      ///< differences of three rows
};

}  // namespace lab::detector
