/// Fits a projector's lens to structured-light observations, with errors over the arena, and
/// decides whether it is accepted. No input or output.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "projector_ctl/calibration/projector_lens.hpp"

namespace lab::calibration {

/// Conditions for a fit to be accepted.
struct ProjectorFitLimits {
  int observations = 200;  ///< at least
  double residual = 1e-3;  ///< [m] rms at most
  double outlying = 0.25;  ///< share of the observations at most
  double covered = 0.9;    ///< share of the arena at least
  /// [m] distance from both walls of a corner within which light must reach
  double dark_corner = 0.005;
};

/// One square of the arena.
struct SquareResidual {
  double x = 0;           ///< [m] its middle
  double y = 0;           ///< [m]
  double residual_x = 0;  ///< [m] found minus wanted place of the light, mean over its observations
  double residual_y = 0;  ///< [m]
  double sigma = 0;       ///< [m] standard error of the mean along each axis
  int observations = 0;
};

struct ProjectorFit {
  optics::CameraParameters lens;
  int observations = 0;    ///< number used
  int outlying = 0;        ///< number excluded: shadows, glare
  double residual = 0;     ///< [m] rms over the observations: found minus fitted place
  double noise = 0;        ///< [m] rms of its random part
  double misfit = 0;       ///< [m] rms over the arena of its part that is common to a square: what
                           ///< the lens model does not describe
  double statistical = 0;  ///< [m] rms standard error over the arena of the fitted lens
  double camera = 0;       ///< [m] rms error of the camera's own calibration, 0 if unknown
  double accuracy = 0;     ///< [m] rms error of the light: misfit, statistical and camera combined
  double covered = 0;      ///< [1] share of the squares with observations
  std::vector<SquareResidual> squares;  ///< row by row from (0, 0)
  int columns = 0;                      ///< of squares
  std::size_t worst = 0;                ///< index of the square with the largest residual
  std::string refusal;                  ///< reason why the fit is rejected; empty if accepted

  /// [m] residual of the worst square.
  [[nodiscard]] double worstResidual() const;
};

/// Bundle adjustment of all observations: pinhole with k1, k2, p1, p2, Huber weights. The noise is
/// estimated from the residuals; observations with residuals above five standard deviations and 0.3
/// mm are excluded.
/// @param camera_error [m] rms of the camera's own calibration; 0: unknown, not included
[[nodiscard]] ProjectorFit fitProjector(const std::vector<ProjectorObservation>& observations,
                                        const ProjectorPlane& plane, double camera_error = 0,
                                        const ProjectorFitLimits& limits = {});

}  // namespace lab::calibration
