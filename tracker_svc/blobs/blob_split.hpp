/// Splits blobs that touch each other: a fit of several ellipses.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/blobs/blob_moments.hpp"

namespace lab::detector {

/// The shape that single blobs have.
struct BlobShape {
  double long_axis = 0;   ///< [px] half of it
  double short_axis = 0;  ///< [px] half of it
  double blur = 0.8;      ///< [px] of the edge, with the pixel's square
  double spread = 0.05;   ///< [1] standard deviation of the sizes

  [[nodiscard]] bool isRound() const { return long_axis < 1.15 * short_axis; }
};

/// One of the blobs of a group.
struct BlobPart {
  optics::Pixel centre;
  double angle = 0;  ///< [rad] of the long axis in the picture; 0 for round ones
  /// [px^2, px rad, rad^2] xx, xy, xt, yy, yt, tt; t only for long ones
  std::array<double, 6> covariance{};
};

struct BlobSplit {
  std::vector<BlobPart> parts;
  double contrast = 0;
  double misfit = 0;  ///< [1] rms of the residuals over the contrast
};

/// Fits `count` blobs of this shape, each with a size of its own.
/// @param starts [px] centres to begin with, may be empty
/// @return empty if the pixels do not determine them
[[nodiscard]] std::optional<BlobSplit> splitBlob(const std::vector<ContrastPixel>& pixels,
                                                 int count, const BlobShape& shape,
                                                 const std::vector<optics::Pixel>& starts);

}  // namespace lab::detector
