/// Geometry of a robot's cap seen from above: a white disc with a big black circle in front and a
/// small one behind, 5 cm above the floor.
#pragma once

#include <optional>

namespace lab::optics {

/// Sizes [m] in the robot's frame: x forward, origin on the robot's axis. The defaults are
/// assumptions of this project (the paper gives none); a calibration file may change them.
struct CapGeometry {
  double robot_radius = 0.0375;
  double cap_radius = 0.036;
  double height = 0.05;  ///< of the cap above the floor
  double big_radius = 0.009;
  double small_radius = 0.0055;
  double big_offset = 0.018;     ///< x of the big circle's centre
  double small_offset = -0.018;  ///< x of the small circle's centre

  /// Distance between the centres of the two circles.
  [[nodiscard]] double spacing() const { return big_offset - small_offset; }

  bool operator==(const CapGeometry&) const = default;
};

/// An impossible size.
struct CapFault {
  const char* size;  ///< its name in CapGeometry
  const char* what;
};

[[nodiscard]] constexpr std::optional<CapFault> capFault(const CapGeometry& cap) {
  if (cap.big_offset < cap.small_offset) {
    return {{"big_offset",
             "the big circle is in front: its offset is more than that of the small one"}};
  }
  if (cap.spacing() < cap.big_radius + cap.small_radius) {
    return {{"big_offset", "the circles overlap: move them apart"}};
  }
  if (cap.small_radius >= cap.big_radius) {
    return {{"small_radius", "the small circle must be smaller than the big one"}};
  }
  if (cap.big_offset + cap.big_radius > cap.cap_radius ||
      cap.small_radius - cap.small_offset > cap.cap_radius) {
    return {{"cap_radius", "a circle reaches beyond the cap's rim"}};
  }
  return std::nullopt;
}

}  // namespace lab::optics
