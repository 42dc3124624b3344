/// What single blobs look like, and how many blobs a region is.
#pragma once

#include <optional>
#include <vector>

#include "tracker_svc/blobs/blob_areas.hpp"
#include "tracker_svc/blobs/blob_moments.hpp"
#include "tracker_svc/blobs/blob_split.hpp"
#include "tracker_svc/blobs/pixel_regions.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/plane_pose.hpp"

namespace lab::detector {

/// A region at half of its contrast.
struct Blob {
  PixelRegion region;
  BlobArea area;
  std::optional<BlobMoments> moments;
  PlanePoint at;        ///< of the middle of the region
  double diameter = 0;  ///< [m] of a disc of its area

  /// [m^2]
  [[nodiscard]] double size() const;
};

/// The usual blur, area and shape: of the single blobs of a picture, or of the last one that had
/// enough of them.
class BlobPopulation {
 public:
  /// @param blur [px] with the pixel's square, until it is learnt
  BlobPopulation(const BlobSettings& settings, double blur) : settings_(settings), blur_(blur) {}

  void learn(const std::vector<Blob>& blobs);

  /// How many blobs a region consists of, by its area.
  [[nodiscard]] int countIn(const Blob& blob) const;

  /// Whether a region is a ring or an arc, such as a shadow: blobs fill their outlines.
  [[nodiscard]] bool isHollow(const Blob& blob) const;

  /// Whether a blob of this area [m^2] is partly hidden. Only known if all areas are nearly equal.
  [[nodiscard]] bool isHidden(double area) const;

  /// @param unit [m] of a pixel
  [[nodiscard]] BlobShape shape(double unit) const {
    return {long_ / unit, short_ / unit, blur_, spread_};
  }

  [[nodiscard]] double blur() const { return blur_; }  ///< [px]
  [[nodiscard]] double area() const { return area_; }  ///< [m^2] 0: not known

 private:
  [[nodiscard]] bool isClean(const Blob& blob) const;

  BlobSettings settings_;
  double blur_;
  double area_ = 0;       ///< [m^2] of one blob
  double long_ = 0;       ///< [m] half of the long axis
  double short_ = 0;      ///< [m]
  double spread_ = 0.05;  ///< [1] standard deviation of lengths
  bool alike_ = false;    ///< whether the areas differ little
  bool equal_ = false;    ///< whether they hardly differ
};

}  // namespace lab::detector
