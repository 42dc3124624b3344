/// Spots, and the dark pixels that may belong to one.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_search/dark_pixels.hpp"

namespace lab::detector {

/// A circle, its centre known to about a tenth of its radius.
struct Spot {
  float x = 0;      ///< [px]
  float y = 0;      ///< [px]
  float white = 0;  ///< [DN] around it, black level subtracted
  bool can_be_big = false;
  bool can_be_small = false;
  float size = 0;  ///< [px] estimated radius
};

/// Something dark that was examined and is no circle.
struct RejectedSpot {
  float x = 0;
  float y = 0;
  float found = 0;  ///< [1] share of directions with an outline at the right distance
  float wanted = 0;
};

/// Expected radii of both circles at one place of the picture.
struct Sizes {
  float big = 0;    ///< [px]
  float small = 0;  ///< [px]
};

inline constexpr int kRayDirections = 16;
inline constexpr int kRaySamples = 48;  ///< [px] along a direction

/// The picture, or a copy of its edges, in the coordinates of the padded picture.
struct Plane {
  optics::GreyView view;
  std::vector<std::int32_t> rays;  ///< [bytes] from a pixel to those around it: by distance [px],
                                   ///< by direction
};

struct GreyLevels {
  int black = 0;  ///< [DN]
  int noise = 0;  ///< [DN] a difference that read noise alone does not cause
};

/// The middle of a run of dark pixels in a row.
struct Candidate {
  int x = 0;
  int y = 0;
  int dark = 0;   ///< [DN]
  int white = 0;  ///< [DN]
  Neighbours to;
  Sizes sizes;
};

/// Whether single pixels are too noisy to judge the candidate.
[[nodiscard]] inline bool isFaint(const Candidate& candidate, const GreyLevels& levels) {
  return candidate.white - candidate.dark < kFaint * levels.noise;
}

/// Moves to the middle of the dark run in its column: a row may cross a circle anywhere.
void moveToMiddle(const Plane& plane, Candidate& candidate);

/// Whether it is dark inside the small circle and bright around the big one, in all directions.
[[nodiscard]] bool isRound(const Plane& plane, const Candidate& candidate);

/// Whether means of several pixels show a contrast: for faint candidates.
[[nodiscard]] bool standsOut(const Plane& plane, const Candidate& candidate, int noise);

/// Sets dark and white. @return whether it is clearly darker than its surroundings
[[nodiscard]] bool isDark(const Plane& plane, const GreyLevels& levels, Candidate& candidate);

}  // namespace lab::detector
