/// Draws detections, identities and rejected candidates on a picture.
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
  std::string label;     ///< text beside it
  bool detected = true;  ///< false: predicted position of a track
};

/// Labels of tracks: "R3" if bound to a robot, else "#12", the number of the track.
[[nodiscard]] std::vector<Mark> marksOf(std::span<const Track> tracks);

struct OverlayInput {
  optics::GreyView picture;
  std::span<const Mark> marks;
  std::span<const detector::Rejection> rejected;
  std::string_view caption;  ///< in the top left corner
  int width = 0;  ///< [px] of the result; 0, or more than the picture's, means that of the picture
};

/// Draws the outline of every cap, its circles and an arrow along its heading: green if both
/// circles were seen, blue if a light edge crosses one, orange for a degraded pose, grey for a
/// track that was not seen. Red crosses are rejected candidates, with the reason and found/allowed
/// value where there is space. A dark picture is brightened; the caption then gives the factor.
[[nodiscard]] optics::RgbImage overlay(const OverlayInput& input, const optics::CameraModel& camera,
                                       const optics::CapGeometry& cap);

/// "size 1.83/1.25": reason, found and allowed value; lengths in cm.
[[nodiscard]] std::string rejectionText(const detector::Rejection& rejection);

}  // namespace lab::tracker
