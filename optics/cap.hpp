/// The cap of a robot as a camera sees it from above: a white disc with a big black circle in front
/// and a small one behind, 5 cm above the floor.
#pragma once

namespace lab::optics {

/// Sizes [m], in the robot's frame: x forward, the robot's axis at 0. The defaults are assumptions
/// of this project (the paper gives none); a calibration file may say others.
struct CapGeometry {
  double robot_radius = 0.0375;
  double cap_radius = 0.036;
  double height = 0.05;  ///< of the cap above the floor
  double big_radius = 0.009;
  double small_radius = 0.0055;
  double big_offset = 0.018;      ///< x of the big circle's centre
  double small_offset = -0.018;   ///< x of the small circle's centre

  /// Between the centres of the two circles.
  [[nodiscard]] double spacing() const { return big_offset - small_offset; }

  bool operator==(const CapGeometry&) const = default;
};

}  // namespace lab::optics
