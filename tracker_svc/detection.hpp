/// Detections of markers in one picture, and why candidates were rejected.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "light/optics/grey_image.hpp"

namespace lab::detector {

/// The features that a pose was computed from; bits.
enum Used : std::uint8_t {
  kUsedBig = 1,     ///< the big circle
  kUsedSmall = 2,   ///< the small circle
  kUsedRim = 4,     ///< the rim of the cap instead of one circle: a degraded pose
  kUsedEdge = 8,    ///< a circle was fitted together with a light edge or a light gradient
  kUsedBlob = 16,   ///< a blob
  kUsedSplit = 32,  ///< one of several blobs that touch each other
  kUsedTag = 64,    ///< a tag
};

/// What is known about the heading of a marker.
enum class HeadingKind : std::uint8_t {
  kDirected,
  kAxis,     ///< up to half a turn: theta is the long axis of a blob
  kUnknown,  ///< theta is 0, its variance that of a uniform distribution
};

struct Detection {
  double x = 0;                        ///< [m] arena frame, the robot's axis
  double y = 0;                        ///< [m]
  double theta = 0;                    ///< [rad] (-pi, pi]
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  float quality = 0;                   ///< [1] 0..1; below 0.5 for a degraded pose
  std::uint8_t used = 0;               ///< bits of Used
  float spacing = 0;     ///< [m] measured between the two circles; 0 unless both were seen
  float white = 0;       ///< [DN] of the cap, black level subtracted
  float ratio = 0;       ///< [1] brightness of the circles' paint over the cap's white
  float blur = 0;        ///< [px] standard deviation of the point spread; 0 unless both were seen
  optics::Pixel big;     ///< centre in the picture, if seen
  optics::Pixel small;   ///< centre in the picture, if seen
  optics::Pixel middle;  ///< image of the axis at cap height, or of the centre of the marker
  HeadingKind heading = HeadingKind::kDirected;
  std::int32_t tag = -1;  ///< number of the tag, -1: not a tag
  float area = 0;         ///< [m^2] of a blob
  /// [m] of a blob: long axis of the ellipse with its second moments; of a tag: measured side
  float length = 0;
  float width = 0;          ///< [m] of a blob: the short axis
  std::uint8_t merged = 1;  ///< how many blobs are in this one, if it could not be split
};

/// Why a candidate for a cap, or for a part of one, was rejected.
enum class Reason : std::uint8_t {
  kCircleFit,  ///< `value`: FitFault
  kSize,       ///< [1] radius over the expected one
  kNoPartner,  ///< a circle without the other one at the right distance
  kSpacing,    ///< [m] distance of the best partner
  kNoCap,      ///< [1] rim contrast around the pair: circles on the bare floor
  kTaken,      ///< its circle belongs to a better pair, or its number to a better tag
  kMerged,     ///< [1] blobs that touch each other and could not be split
  kPattern,    ///< [1] residuals over the contrast: a tag whose pattern does not fit
};
[[nodiscard]] std::string_view toText(Reason reason);

struct Rejection {
  optics::Pixel where;
  Reason reason = Reason::kCircleFit;
  float value = 0;  ///< found
  float limit = 0;  ///< allowed
};

/// Where a cap is expected.
struct Expected {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
  double reach = 0;  ///< [m] largest distance of the cap from (x, y)
  double turn = 0;   ///< [rad] largest deviation of its heading from theta
};

}  // namespace lab::detector
