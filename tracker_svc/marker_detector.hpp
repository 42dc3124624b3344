/// What finds markers in one picture: the interface of the detectors of caps, blobs and tags.
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/detection.hpp"

namespace lab::detector {

class MarkerDetector {
 public:
  MarkerDetector() = default;
  MarkerDetector(MarkerDetector&&) noexcept = default;
  MarkerDetector& operator=(MarkerDetector&&) noexcept = default;
  MarkerDetector(const MarkerDetector&) = delete;
  MarkerDetector& operator=(const MarkerDetector&) = delete;
  virtual ~MarkerDetector() = default;

  /// Finds every marker in the picture.
  /// @param rejected if not null, receives the rejected candidates
  /// @param expected where markers are expected from earlier pictures
  /// @return valid until the next call
  virtual const std::vector<Detection>& search(const optics::GreyView& picture,
                                               std::vector<Rejection>* rejected = nullptr,
                                               std::span<const Expected> expected = {}) = 0;

  /// Finds only the markers near expected places. Result i belongs to expected[i]; its quality is 0
  /// if no marker was found there.
  virtual const std::vector<Detection>& follow(const optics::GreyView& picture,
                                               std::span<const Expected> expected) = 0;

  /// Says whether the following pictures went through a lossy codec.
  virtual void setCompressed(bool compressed) = 0;

  /// Sets the gamma of the following pictures (Imaging::gamma).
  virtual void setGamma(double gamma) = 0;

  [[nodiscard]] virtual const optics::CameraModel& camera() const = 0;
};

/// What marks the robots, animals or particles.
enum class MarkerKind : std::uint8_t { kCaps, kBlobs, kTags };

/// Single spots: animals, colloids, dots on robots.
struct BlobSettings {
  bool bright = false;      ///< brighter than the ground; else darker
  double smallest = 0.004;  ///< [m] diameter of a disc of the smallest area of one blob
  double largest = 0.04;    ///< [m] diameter of a disc of the largest area of one blob
  double height = 0;        ///< [m] of the blobs above the floor
  double arena_width = 0;   ///< [m] blobs beyond the arena are ignored; 0: none are
  double arena_height = 0;  ///< [m]
};

/// AprilTags.
struct TagSettings {
  std::string family = "tag36h11";  ///< one of optics::tagFamilies()
  double size = 0.04;               ///< [m] side of the square between white and black border
  double height = 0.05;             ///< [m] of the tags above the floor
};

/// What a detector looks for.
struct MarkerSettings {
  MarkerKind kind = MarkerKind::kCaps;
  BlobSettings blobs;
  TagSettings tags;

  /// [m] of the markers above the floor
  [[nodiscard]] double height(const optics::CapGeometry& cap) const {
    if (kind == MarkerKind::kBlobs) return blobs.height;
    return kind == MarkerKind::kTags ? tags.height : cap.height;
  }

  /// The outline that is drawn around a marker: cap_radius at the height of the markers.
  [[nodiscard]] optics::CapGeometry outline(optics::CapGeometry cap) const {
    cap.height = height(cap);
    if (kind == MarkerKind::kBlobs) cap.cap_radius = blobs.largest / 2;
    if (kind == MarkerKind::kTags) cap.cap_radius = tags.size / std::numbers::sqrt2;
    return cap;
  }
};

/// The detector of these markers.
/// @throws std::invalid_argument if a family of tags is unknown
[[nodiscard]] std::unique_ptr<MarkerDetector> makeMarkerDetector(const MarkerSettings& settings,
                                                                 const optics::CameraModel& camera,
                                                                 const optics::CapGeometry& cap,
                                                                 const optics::Imaging& imaging);

/// Finds blobs. They must be darker (or brighter) than the ground by a fifth, and the ground must
/// not change by much over two of the largest diameters.
[[nodiscard]] std::unique_ptr<MarkerDetector> makeBlobDetector(const optics::CameraModel& camera,
                                                               const optics::Imaging& imaging,
                                                               const BlobSettings& settings);

/// Finds tags with libapriltag, and refines their poses by a fit to the picture.
/// @throws std::invalid_argument if the family is unknown
[[nodiscard]] std::unique_ptr<MarkerDetector> makeTagDetector(const optics::CameraModel& camera,
                                                              const optics::Imaging& imaging,
                                                              const TagSettings& settings);

}  // namespace lab::detector
