/// What the tracker saw in a picture, drawn on it: caps, identities, and what was refused and why.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "light/optics/rgb_image.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/tracking/cap_tracker.hpp"

namespace lab::tracker {

/// One cap to draw.
struct Mark {
  detector::Detection pose;
  std::string label;  ///< beside it
  bool seen = true;   ///< false: this is where it is thought to be
};

/// Of tracks: "R3" where bound to a robot, else "#12", the number of the track.
[[nodiscard]] std::vector<Mark> marksOf(std::span<const Track> tracks);

struct OverlayInput {
  optics::GreyView picture;
  std::span<const Mark> marks;
  std::span<const detector::Rejection> rejected;
  std::string_view caption;  ///< in the top left corner
  int width = 0;             ///< [px] of the result, 0: of the picture; never more
};

/// The picture with the outline of every cap, its circles and an arrow along its heading: green
/// where both circles were seen, blue where a light edge crosses one, orange for a degraded pose,
/// grey where a track was not seen. Crosses in red are candidates that were refused, with the
/// reason and found/allowed where there is room for the text. A picture too dark for people is made
/// brighter, and says so.
[[nodiscard]] RgbImage overlay(const OverlayInput& input, const optics::CameraModel& camera,
                               const optics::CapGeometry& cap);

/// "size 1.83/1.25": reason, found and allowed, lengths in cm.
[[nodiscard]] std::string rejectionText(const detector::Rejection& rejection);

}  // namespace lab::tracker
