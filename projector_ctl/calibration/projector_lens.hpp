/// Fits a projector's lens to pixels and the places they light. No input or output.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "light/optics/camera_model.hpp"

namespace lab::calibration {

/// One pixel of the projector's picture and the place that it lights.
struct ProjectorObservation {
  optics::Place place;  ///< [m] at `height` of ProjectorPlane
  optics::Pixel pixel;
  double sigma = 0.05;  ///< [px] along each axis; only ratios matter
};

/// Properties common to all observations.
struct ProjectorPlane {
  int columns = 0;             ///< [px] of the picture
  int rows = 0;                ///< [px]
  double arena_width = 1.20;   ///< [m]
  double arena_height = 0.90;  ///< [m]
  double height = 0.05;        ///< [m] of the places above the floor
};

/// The best-fitting projector above the arena's middle that points straight down: the start of the
/// fit. fx is negative if the light passes a mirror. Empty for fewer than three observations, or
/// collinear ones.
[[nodiscard]] std::optional<optics::CameraParameters> straightLens(
    const std::vector<ProjectorObservation>& observations, const ProjectorPlane& plane);

/// Observed minus fitted [px]: x and y of each observation in turn.
[[nodiscard]] Eigen::VectorXd pixelResiduals(const std::vector<ProjectorObservation>& observations,
                                             const ProjectorPlane& plane,
                                             const optics::CameraParameters& lens);

/// Weak priors, because one plane does not determine a complete lens: f to 50 %, fy / fx to 30 %,
/// the principal point to the picture's size, the throw to 50 %, k1 to 2, k2 to 10, p1 and p2 to
/// 0.1. The map between pixels and places hardly depends on them.
/// @param with_distortion false: k1 = k2 = p1 = p2 = 0
[[nodiscard]] ResidualBlock projectorPrior(const optics::CameraParameters& start,
                                           const ProjectorPlane& plane, bool with_distortion);

/// Residuals of the observations in units of `noise` times their sigma.
[[nodiscard]] ResidualBlock observationBlock(const std::vector<ProjectorObservation>& observations,
                                             const ProjectorPlane& plane, double noise,
                                             bool robust);

/// The lens without distortion that lights the arena's corners (0, 0), (width, 0), (width, height),
/// (0, height) with these pixels: a manual calibration. Accurate to 0.01 px, and to 0.5 px for
/// corners that hardly any lens can produce. The corners may lie outside the picture. Empty if they
/// do not form a convex quadrangle, or if no lens fits: 1 in 100 of random corners within 5 % of a
/// rectangle.
[[nodiscard]] std::optional<optics::CameraParameters> lensFromCorners(
    const std::array<optics::Pixel, 4>& corners, const ProjectorPlane& plane);

}  // namespace lab::calibration
