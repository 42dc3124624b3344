/// A projector's lens from pixels and the places that they fall on: numbers in, numbers out.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "light/optics/camera_model.hpp"

namespace lab::calibration {

/// One pixel of the projector's picture and where its light was found.
struct ProjectorObservation {
  optics::Place place;  ///< [m] at `height` of ProjectorPlane
  optics::Pixel pixel;
  double sigma = 0.05;  ///< [px] along each axis; only ratios matter
};

/// What the sights have in common.
struct ProjectorPlane {
  int columns = 0;             ///< [px] of the picture
  int rows = 0;                ///< [px]
  double arena_width = 1.20;   ///< [m]
  double arena_height = 0.90;  ///< [m]
  double height = 0.05;        ///< [m] above the floor, of the places
};

/// The projector above the arena's middle, looking straight down, that fits best: where the search
/// begins. A negative fx where the picture is seen in a mirror. Empty for fewer than three sights,
/// or for sights in one line.
[[nodiscard]] std::optional<optics::CameraParameters> straightLens(
    const std::vector<ProjectorObservation>& observations, const ProjectorPlane& plane);

/// Seen less fitted [px]: x and y of each sight in turn.
[[nodiscard]] Eigen::VectorXd pixelResiduals(const std::vector<ProjectorObservation>& observations,
                                             const ProjectorPlane& plane,
                                             const optics::CameraParameters& lens);

/// One plane does not tell a whole lens. These are held near what projectors are, only so far that
/// the search has an end: f to half of it, fy / fx to 30 %, the principal point to the picture's
/// size, the throw to half of it, k1 to 2, k2 to 10, p1 and p2 to 0.1. The map between pixels and
/// places hardly depends on it.
/// @param with_distortion false: k1 = k2 = p1 = p2 = 0
[[nodiscard]] ResidualBlock projectorPrior(const optics::CameraParameters& start,
                                           const ProjectorPlane& plane, bool with_distortion);

/// The sights in units of `noise` times their sigma.
[[nodiscard]] ResidualBlock observationBlock(const std::vector<ProjectorObservation>& observations,
                                             const ProjectorPlane& plane, double noise,
                                             bool robust);

/// The lens that lights the arena's corners (0, 0), (width, 0), (width, height), (0, height) with
/// these pixels, without distortion: a calibration by hand. To 0.01 px, and to 0.5 px where the
/// corners are such that hardly any lens does it. The corners may lie outside the picture. Empty
/// where they cross, or where no lens does it: 1 in 100 of those drawn within 5 % of a rectangle.
[[nodiscard]] std::optional<optics::CameraParameters> lensFromCorners(
    const std::array<optics::Pixel, 4>& corners, const ProjectorPlane& plane);

}  // namespace lab::calibration
