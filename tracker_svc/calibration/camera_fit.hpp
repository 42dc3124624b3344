/// Calibrates a camera from the corners of the arena, caps whose circles have a known spacing, and
/// pictures of a board. No input or output.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"

namespace lab::calibration {

/// Images of the inner corners of the arena at floor height, in the order (0, 0), (width, 0),
/// (width, height), (0, height): counter-clockwise seen from above.
using Corners = std::array<optics::Pixel, 4>;

/// The two circles of one cap in one picture: centres of their ellipses.
struct CapObservation {
  optics::Pixel big;
  optics::Pixel small;
  double sigma = 0.02;  ///< [px] of each centre, along each axis; only ratios matter
};

/// One disc of the board.
struct BoardPoint {
  double x = 0;  ///< [m] on the board
  double y = 0;  ///< [m]
  optics::Pixel pixel;
  double sigma = 0.02;  ///< [px]
};

/// The board in one picture, at any pose in front of the camera.
struct BoardView {
  double disc_radius = 0;  ///< [m]
  std::vector<BoardPoint> points;
};

struct CameraObservations {
  int width = 0;               ///< [px] of the pictures
  int height = 0;              ///< [px]
  double arena_width = 1.20;   ///< [m]
  double arena_height = 0.90;  ///< [m]
  optics::CapGeometry cap;
  Corners corners;
  double corner_sigma = 0.5;  ///< [px] along each axis
  std::vector<CapObservation> caps;
  std::vector<BoardView> boards;
  std::optional<double> camera_height;  ///< [m] above the floor, if measured
  double camera_height_sigma = 0.01;    ///< [m] its standard error
  bool with_k3 = false;                 ///< fit k3 too: for wide-angle lenses
};

/// Conditions for a fit to be accepted.
struct CameraFitLimits {
  int caps = 60;                      ///< observations at least, without a board
  int caps_in_part = 3;               ///< in each ninth of the arena
  double spacing_residual = 0.15e-3;  ///< [m] rms at most
  double board_residual = 0.2;        ///< [px] rms at most
  double corner_residual = 3;         ///< [1] rms at most, in units of corner_sigma
  double height_residual = 3;         ///< [1] at most, in units of camera_height_sigma
  double outlying = 0.2;              ///< share of the caps at most
  double position_error = 1.5e-3;     ///< [m] standard error, rms over the arena, at most
};

/// Standard error of positions on the cap plane at one place of the arena.
struct PlaceError {
  double x = 0;              ///< [m]
  double y = 0;              ///< [m]
  double frame = 0;          ///< [m] of the position in the arena frame
  double spacing = 0;        ///< [m] mean of measured minus known spacing of the caps nearby
  double spacing_sigma = 0;  ///< [m] its standard error; 0 if there are no caps
  int caps = 0;
};

struct ErrorMap {
  static constexpr int kColumns = 5;
  static constexpr int kRows = 5;
  std::array<PlaceError, kColumns * kRows> places;  ///< from (0, 0), row by row
  double rms = 0;                                   ///< [m] of the standard errors over the arena
  double largest = 0;                               ///< [m]
  double shape = 0;  ///< [m] rms after removing a common shift and rotation: errors of
                     ///< distances and motion, which do not depend on the marked corners
};

struct CameraFit {
  optics::CameraParameters camera;
  optics::CameraParameters error;  ///< standard errors; of the pose: `height_error`, `foot_error`
  double height = 0;               ///< [m] of the camera above the floor
  double height_error = 0;         ///< [m]
  double foot_error = 0;           ///< [m] of the point of the floor below the camera
  int caps = 0;                    ///< number of observations used
  int outlying = 0;                ///< number of observations excluded
  double cap_noise = 0;            ///< [px] of a circle's centre along an axis, estimated
  double spacing_residual = 0;     ///< [m] rms
  double board_residual = 0;       ///< [px] rms along each axis
  double corner_residual = 0;      ///< [px] rms along each axis
  ErrorMap map;
  std::string refusal;  ///< reason why the fit is rejected; empty if accepted
};

/// Why these cannot be the corners of the arena; empty if they can.
[[nodiscard]] std::string cornerFault(const Corners& corners, int width, int height,
                                      double arena_width, double arena_height);

/// An initial camera from the corners alone: square pixels, the principal point in the middle, and
/// the camera at the given height. Lengths on the cap plane are accurate to 2 % if the height is
/// accurate to 50 % and k1 is right.
/// @param camera_height [m] above the floor, 0: 1.4 times the longer side of the arena
[[nodiscard]] optics::CameraParameters guessFromCorners(const CameraObservations& observations,
                                                        double camera_height = 0, double k1 = 0);

/// Bundle adjustment of fx, fy, cx, cy, k1, k2, p1, p2 (and k3), the camera's pose, the pose of
/// each board, and a common scale error of the caps. Each cap contributes one residual: the
/// distance between its circles on the cap plane. Levenberg-Marquardt with Huber weights; the noise
/// of caps and boards is estimated from the residuals.
///
/// One flat arena does not determine all unknowns. These have priors with the following standard
/// deviations: fy = fx to 0.2 %, cx and cy in the middle to 2 % of the width, p1 and p2 0 to 0.001,
/// k2 0 to 0.3, scale of the caps to 0.05 %. The standard errors include them.
[[nodiscard]] CameraFit fitCamera(const CameraObservations& observations,
                                  const std::optional<optics::CameraParameters>& start = {},
                                  const CameraFitLimits& limits = {});

}  // namespace lab::calibration
