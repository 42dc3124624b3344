/// Centre, size and axis of one blob from the moments of its contrast, with their errors.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/blobs/blob_areas.hpp"
#include "tracker_svc/blobs/blob_ground.hpp"

namespace lab::detector {

struct BlobMoments {
  optics::Pixel centre;
  std::array<double, 3> covariance{};  ///< [px^2] of the centre: xx, xy, yy
  std::array<double, 3> second{};      ///< [px^2] central second moments: xx, xy, yy
  std::array<double, 3> outline{};     ///< [px^2] the same of the area inside the outline
  /// [px^4] covariance of (xx - yy) / 2 and xy of `outline`, as xx, xy, yy
  std::array<double, 3> outline_covariance{};
  double mass = 0;  ///< [px] contrast, summed over the pixels
  double contrast =
      0;              ///< [1] of the inside, over the light of the ground; or [DN], see `relative`
  double noise = 0;   ///< standard deviation of one pixel, in units of `contrast`
  double ground = 0;  ///< [DN] the ground's light without black
  /// The contrast is relative to the light of the ground, so that uneven light does not move the
  /// centre. Not on dark ground, which says nothing about the light, and not for bright blobs,
  /// whose contrast is larger than the light of the ground.
  bool relative = false;
};

/// Centre and outline are moments of the contrast, clipped such that noise inside and outside of
/// the blob does not count: only its edge does. Where the noise is too large for that, all pixels
/// count. The ground around a blob is a plane fitted to the ring of its area. The error of the
/// plane, the noise of every pixel and the noise of the ring, which may be more than the camera's,
/// are in the covariances.
/// @param edge [steps] of the area that belong to the blob; the others are the ring
/// @return empty if nothing stands out
[[nodiscard]] std::optional<BlobMoments> blobMoments(const optics::GreyView& picture,
                                                     const BlobArea& area, int edge,
                                                     const BlobGround& ground, bool bright);

/// A pixel of a blob, in the units of BlobMoments::contrast.
struct ContrastPixel {
  double x = 0;  ///< [px]
  double y = 0;  ///< [px]
  double contrast = 0;
  double variance = 0;
};

/// The contrasts of the pixels of several areas, with one plane as their ground.
[[nodiscard]] std::vector<ContrastPixel> contrastPixels(const optics::GreyView& picture,
                                                        const std::vector<const BlobArea*>& areas,
                                                        int edge, const BlobGround& ground,
                                                        bool bright);

}  // namespace lab::detector
