#include "tracker_svc/calibration/camera_fit_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "light/median.hpp"

namespace lab::calibration {
namespace {

constexpr double kUnsure = 0.06;  // [px] error of a circle's centre; usual values are 0.005 to 0.03

/// Describes one ninth of the arena in words.
std::string partName(int column, int row) {
  if (column == 1 && row == 1) return "the middle";
  std::string name = row == 0 ? "low y" : row == 2 ? "high y" : "";
  if (column != 1)
    name += std::string(name.empty() ? "" : ", ") + (column == 0 ? "low x" : "high x");
  return (column == 1 || row == 1 ? "the side of " : "the corner of ") + name;
}

/// Advice on possible causes of spacing residuals.
std::string spacingAdvice(const CameraObservations& observations) {
  std::vector<double> sigmas;
  for (const CapObservation& cap : observations.caps) sigmas.push_back(cap.sigma);
  if (!sigmas.empty()) {
    const double typical = medianOf(sigmas);
    if (typical > kUnsure) {
      return fmt::format(
          "circles are found to {:.2f} px only: more light, a sharper picture, a film "
          "without loss (docs/track.md)",
          typical);
    }
  }
  return "is that their spacing, is the picture sharp, are all caps made alike?";
}

}  // namespace

double heightResidual(const CameraObservations& observations,
                      const optics::CameraParameters& camera) {
  if (!observations.camera_height) return 0;
  return (optics::CameraModel(camera).centre()[2] - *observations.camera_height) /
         observations.camera_height_sigma;
}

std::string coverageFault(const CameraObservations& observations,
                          const optics::CameraParameters& camera, const CameraFitLimits& limits) {
  const auto found = static_cast<int>(observations.caps.size());
  if (found < limits.caps) {
    return fmt::format(
        "found {} caps (each position and heading counts once), needed {}: film longer, "
        "with robots that drive all over the arena",
        found, limits.caps);
  }
  const optics::CameraModel model(camera);
  std::array<int, 9> parts{};
  for (const CapObservation& observation : observations.caps) {
    const auto place = model.toPlane(observation.big, observations.cap.height);
    if (!place) continue;
    const int column = std::clamp(static_cast<int>(3 * place->x / observations.arena_width), 0, 2);
    const int row = std::clamp(static_cast<int>(3 * place->y / observations.arena_height), 0, 2);
    ++parts[static_cast<std::size_t>(3 * row + column)];
  }
  for (int part : {0, 2, 6, 8, 1, 3, 5, 7, 4}) {
    const int here = parts[static_cast<std::size_t>(part)];
    if (here >= limits.caps_in_part) continue;
    const int column = part % 3;
    const int row = part / 3;
    return fmt::format(
        "found {} caps in {} (x {:.0f} to {:.0f} cm, y {:.0f} to {:.0f} cm), needed "
        "{}: film robots there too",
        here, partName(column, row), 100 * observations.arena_width * column / 3,
        100 * observations.arena_width * (column + 1) / 3,
        100 * observations.arena_height * row / 3, 100 * observations.arena_height * (row + 1) / 3,
        limits.caps_in_part);
  }
  return {};
}

std::string refusalOf(const CameraObservations& observations, const CameraFit& fit,
                      const CameraFitLimits& limits) {
  const auto seen = static_cast<double>(fit.caps + fit.outlying);
  if (fit.outlying > limits.outlying * seen) {
    return fmt::format(
        "{} of {} caps do not fit to the others, allowed {:.0f} %: are these caps, "
        "and are the corners right?",
        fit.outlying, fit.caps + fit.outlying, 100 * limits.outlying);
  }
  if (std::abs(heightResidual(observations, fit.camera)) > limits.height_residual) {
    return fmt::format(
        "the fitted height of the camera is {:.1f} cm, measured {:.1f}: are the arena's "
        "size, the caps' height and their spacing right?",
        100 * fit.height, 100 * *observations.camera_height);
  }
  const double corners = fit.corner_residual / observations.corner_sigma;
  if (corners > limits.corner_residual) {
    return fmt::format(
        "the corners differ from the fit by {:.1f} px (rms), allowed {:.1f}: mark the inner "
        "corners "
        "at floor height; do they begin at (0, 0), and are --arena-cm and the caps' "
        "height and spacing right?",
        fit.corner_residual, limits.corner_residual * observations.corner_sigma);
  }
  if (fit.spacing_residual > limits.spacing_residual) {
    return fmt::format(
        "the circles' spacing differs from {:.1f} mm by {:.2f} mm (rms), allowed {:.2f}: {}",
        1e3 * observations.cap.spacing(), 1e3 * fit.spacing_residual, 1e3 * limits.spacing_residual,
        spacingAdvice(observations));
  }
  if (fit.board_residual > limits.board_residual) {
    return fmt::format(
        "the board's discs differ from the fit by {:.2f} px (rms), allowed {:.2f}: is the board "
        "flat, "
        "and did it stand still?",
        fit.board_residual, limits.board_residual);
  }
  if (!(fit.map.rms <= limits.position_error)) {
    return fmt::format(
        "the standard error of positions is {:.1f} mm (rms over the arena), allowed {:.1f}: use "
        "more "
        "caps all over the arena, and mark the corners more accurately",
        1e3 * fit.map.rms, 1e3 * limits.position_error);
  }
  return {};
}

}  // namespace lab::calibration
