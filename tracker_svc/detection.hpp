/// Detections of caps in one picture, and why candidates were rejected.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "light/optics/grey_image.hpp"

namespace lab::detector {

/// The features that a pose was computed from; bits.
enum Used : std::uint8_t {
  kUsedBig = 1,    ///< the big circle
  kUsedSmall = 2,  ///< the small circle
  kUsedRim = 4,    ///< the rim of the cap instead of one circle: a degraded pose
  kUsedEdge = 8,   ///< a circle was fitted together with a light edge or a light gradient
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
  optics::Pixel middle;  ///< image of the axis at cap height
};

/// Why a candidate for a cap, or for a part of one, was rejected.
enum class Reason : std::uint8_t {
  kCircleFit,  ///< `value`: FitFault
  kSize,       ///< [1] radius over the expected one
  kNoPartner,  ///< a circle without the other one at the right distance
  kSpacing,    ///< [m] distance of the best partner
  kNoCap,      ///< [1] rim contrast around the pair: circles on the bare floor
  kTaken,      ///< its circle belongs to a better pair
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
