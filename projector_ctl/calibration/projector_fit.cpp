#include "projector_ctl/calibration/projector_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "light/median.hpp"
#include "light/optics/projector_model.hpp"

namespace lab::calibration {
namespace {

using Eigen::VectorXd;

constexpr int kRounds = 5;
constexpr double kOutlying = 5;          // [standard deviations]
constexpr double kNeverOutlying = 3e-4;  // [m] residuals below this are never outliers
constexpr double kRayleighMedian = 1.17741;
constexpr double kSquare = 0.1;  // [m] approximate side of a square
constexpr int kFewestInSquare = 3;
constexpr int kErrorSteps = 8;  // steps per axis of the grid on which errors are averaged
constexpr double kMilli = 1e3;
constexpr double kCenti = 100;

struct Miss {
  optics::Place place;
  double x = 0;  // [m]
  double y = 0;  // [m]
};

/// Standard deviation along each axis from the median of the residuals' lengths, which outliers
/// hardly change.
double robustSigma(const VectorXd& residuals) {
  std::vector<double> sizes;
  for (Eigen::Index row = 0; row + 1 < residuals.size(); row += 2) {
    sizes.push_back(residuals.segment<2>(row).norm());
  }
  return std::max(medianOf(sizes) / kRayleighMedian, 1e-3);
}

std::vector<Miss> missesOf(const std::vector<ProjectorObservation>& observations,
                           const ProjectorPlane& plane, const optics::CameraParameters& lens) {
  const optics::CameraModel model(lens);
  std::vector<Miss> misses;
  for (const ProjectorObservation& observation : observations) {
    const auto fitted = model.toPlane(observation.pixel, plane.height);
    if (!fitted) continue;
    misses.push_back(
        {observation.place, observation.place.x - fitted->x, observation.place.y - fitted->y});
  }
  return misses;
}

struct Fitted {
  CameraSolution solution;
  std::vector<ProjectorObservation> used;
  double noise = 1;  ///< in units of the observations' sigmas
};

/// Removes outliers, unless the lens is not found yet.
std::vector<ProjectorObservation> fitting(const std::vector<ProjectorObservation>& observations,
                                          const ProjectorPlane& plane, const Fitted& fitted) {
  const optics::CameraParameters& lens = fitted.solution.state.camera;
  const VectorXd misses = pixelResiduals(observations, plane, lens);
  const optics::PlaneScale scale = optics::CameraModel(lens).scaleAt(
      {plane.arena_width / 2, plane.arena_height / 2}, plane.height);
  const double pixels_a_metre = std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
  std::vector<ProjectorObservation> kept;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double miss = misses.segment<2>(2 * static_cast<Eigen::Index>(i)).norm();
    const double most =
        std::max(kOutlying * fitted.noise * observations[i].sigma, kNeverOutlying * pixels_a_metre);
    if (miss < most) kept.push_back(observations[i]);
  }
  return kept;
}

Fitted fitAll(const std::vector<ProjectorObservation>& observations, const ProjectorPlane& plane,
              const optics::CameraParameters& start) {
  Fitted fitted;
  fitted.used = observations;
  fitted.solution.state.camera = start;
  fitted.solution.state.pivot = {plane.arena_width / 2, plane.arena_height / 2, plane.height};
  const ResidualBlock prior = projectorPrior(start, plane, true);
  for (int round = 0; round < kRounds; ++round) {
    const ResidualBlock plain = observationBlock(fitted.used, plane, 1, false);
    fitted.noise = robustSigma(plain.residuals(fitted.solution.state));
    fitted.solution = solveCamera({observationBlock(fitted.used, plane, fitted.noise, true), prior},
                                  fitted.solution.state);
    if (round + 2 != kRounds) continue;
    fitted.noise = robustSigma(plain.residuals(fitted.solution.state));
    auto kept = fitting(observations, plane, fitted);
    if (kept.size() < 10) break;
    fitted.used = std::move(kept);
  }
  return fitted;
}

/// [m^2] mean squared standard error of the place that a pixel lights.
double statisticalError(const Fitted& fitted, const ProjectorPlane& plane) {
  ResidualBlock block;
  for (int i = 0; i < kSpacing; ++i) block.unknowns.push_back(i);
  const optics::CameraModel now(fitted.solution.state.camera);
  block.residuals = [&](const CameraState& at) -> VectorXd {
    const optics::CameraModel model(at.camera);
    VectorXd out(2 * (kErrorSteps + 1) * (kErrorSteps + 1));
    Eigen::Index row = 0;
    for (int j = 0; j <= kErrorSteps; ++j) {
      for (int i = 0; i <= kErrorSteps; ++i) {
        const double x = plane.arena_width * i / kErrorSteps;
        const double y = plane.arena_height * j / kErrorSteps;
        const auto moved = model.toPlane(now.project(x, y, plane.height), plane.height);
        out[row++] = moved ? moved->x : 0;
        out[row++] = moved ? moved->y : 0;
      }
    }
    return out;
  };
  const Eigen::MatrixXd slopes = jacobianOf(block, fitted.solution.state);
  const Eigen::MatrixXd errors =
      slopes * fitted.solution.covariance.topLeftCorner(kSpacing, kSpacing) * slopes.transpose();
  return errors.trace() / ((kErrorSteps + 1) * (kErrorSteps + 1));
}

void addSquares(ProjectorFit& fit, const std::vector<Miss>& misses, const ProjectorPlane& plane) {
  fit.columns = std::max(1, static_cast<int>(std::lround(plane.arena_width / kSquare)));
  const int rows = std::max(1, static_cast<int>(std::lround(plane.arena_height / kSquare)));
  fit.squares.resize(static_cast<std::size_t>(fit.columns) * static_cast<std::size_t>(rows));
  std::vector<double> squares(fit.squares.size());
  const auto part = [](double along, double length, int parts) {
    return std::clamp(static_cast<int>(along / length * parts), 0, parts - 1);
  };
  for (const Miss& miss : misses) {
    const int i = part(miss.place.x, plane.arena_width, fit.columns);
    const int j = part(miss.place.y, plane.arena_height, rows);
    const auto at = static_cast<std::size_t>(j * fit.columns + i);
    SquareResidual& square = fit.squares[at];
    ++square.observations;
    square.residual_x += miss.x;
    square.residual_y += miss.y;
    squares[at] += miss.x * miss.x + miss.y * miss.y;
  }
  double scatter = 0;  // scatter of the observations about the means of their squares
  double freedom = 0;
  double common = 0;
  double chance = 0;  // expected squares of the means without any misfit
  int seen = 0;
  int judged = 0;
  for (std::size_t at = 0; at < squares.size(); ++at) {
    SquareResidual& square = fit.squares[at];
    square.x = (static_cast<double>(at % static_cast<std::size_t>(fit.columns)) + 0.5) *
               plane.arena_width / fit.columns;
    square.y = (static_cast<double>(at / static_cast<std::size_t>(fit.columns)) + 0.5) *
               plane.arena_height / rows;
    if (square.observations == 0) continue;
    ++seen;
    const double count = square.observations;
    square.residual_x /= count;
    square.residual_y /= count;
    if (square.observations < kFewestInSquare) continue;
    const double mean2 =
        square.residual_x * square.residual_x + square.residual_y * square.residual_y;
    const double inside = std::max(0.0, squares[at] - count * mean2);
    square.sigma = std::sqrt(inside / (2 * (count - 1) * count));
    scatter += inside;
    freedom += count - 1;
    common += mean2;
    chance += 2 * square.sigma * square.sigma;
    ++judged;
    if (std::sqrt(mean2) > fit.worstResidual()) fit.worst = at;
  }
  fit.covered = static_cast<double>(seen) / static_cast<double>(squares.size());
  if (judged == 0) return;
  fit.noise = std::sqrt(scatter / freedom);
  fit.misfit = std::sqrt(std::max(0.0, (common - chance) / judged));
}

std::string darkCorners(const ProjectorFit& fit, const ProjectorPlane& plane, double inside) {
  const optics::ProjectorModel model(fit.lens, plane.height);
  const double w = plane.arena_width;
  const double h = plane.arena_height;
  std::string dark;
  for (const auto& [x, y, far_x, far_y] :
       {std::array{0.0, 0.0, inside, inside}, std::array{w, 0.0, w - inside, inside},
        std::array{w, h, w - inside, h - inside}, std::array{0.0, h, inside, h - inside}}) {
    const optics::Pixel pixel = model.pixelOf({far_x, far_y});
    if (pixel.x >= -0.5 && pixel.y >= -0.5 && pixel.x <= plane.columns - 0.5 &&
        pixel.y <= plane.rows - 0.5) {
      continue;
    }
    dark += fmt::format("{}({:g}, {:g}) cm", dark.empty() ? "" : " and ", kCenti * x, kCenti * y);
  }
  return dark;
}

std::string refusalOf(const ProjectorFit& fit, const ProjectorPlane& plane,
                      const ProjectorFitLimits& limits) {
  const double all = fit.observations + fit.outlying;
  const std::string dark = darkCorners(fit, plane, limits.dark_corner);
  if (fit.outlying > limits.outlying * all) {
    return fmt::format(
        "{:.0f} % of the observations are outliers, allowed {:.0f} %: are there shadows, "
        "glare, or something on the board?",
        100 * fit.outlying / all, 100 * limits.outlying);
  }
  if (!(fit.residual <= limits.residual)) {
    return fmt::format(
        "the observations deviate from the fitted lens by {:.2f} mm (rms), allowed {:.2f} mm: is "
        "the "
        "board flat and level, and the camera's calibration still right?",
        kMilli * fit.residual, kMilli * limits.residual);
  }
  if (!dark.empty()) {
    return fmt::format(
        "the picture does not reach the arena's corner {}: move the projector, or zoom "
        "out, until it covers the arena",
        dark);
  }
  if (fit.covered < limits.covered) {
    return fmt::format(
        "the pattern was seen on {:.0f} % of the arena, needed {:.0f} %: lay the board "
        "over all of it",
        100 * fit.covered, 100 * limits.covered);
  }
  return {};
}

}  // namespace

double ProjectorFit::worstResidual() const {
  return squares.empty() ? 0 : std::hypot(squares[worst].residual_x, squares[worst].residual_y);
}

ProjectorFit fitProjector(const std::vector<ProjectorObservation>& observations,
                          const ProjectorPlane& plane, double camera_error,
                          const ProjectorFitLimits& limits) {
  ProjectorFit fit;
  fit.observations = static_cast<int>(observations.size());
  fit.camera = camera_error;
  if (fit.observations < limits.observations) {
    fit.refusal = fmt::format(
        "the pattern was seen in {} places, needed {}: is the projector on, its picture sharp, the "
        "white board in the camera's view, and the exposure neither too short nor too long?",
        fit.observations, limits.observations);
    return fit;
  }
  const auto start = straightLens(observations, plane);
  if (!start) {
    fit.refusal = "all places where the pattern was seen lie in one line";
    return fit;
  }
  const Fitted fitted = fitAll(observations, plane, *start);
  fit.lens = fitted.solution.state.camera;
  fit.lens.k3 = 0;
  fit.observations = static_cast<int>(fitted.used.size());
  fit.outlying = static_cast<int>(observations.size()) - fit.observations;
  const std::vector<Miss> misses = missesOf(fitted.used, plane, fit.lens);
  double sum = 0;
  for (const Miss& miss : misses) sum += miss.x * miss.x + miss.y * miss.y;
  fit.residual = misses.empty() ? HUGE_VAL : std::sqrt(sum / static_cast<double>(misses.size()));
  addSquares(fit, misses, plane);
  if (!fitted.solution.determined) {
    fit.refusal = "the observations do not determine the lens";
    return fit;
  }
  fit.statistical = std::sqrt(statisticalError(fitted, plane));
  fit.accuracy = std::sqrt(fit.misfit * fit.misfit + fit.statistical * fit.statistical +
                           fit.camera * fit.camera);
  fit.refusal = refusalOf(fit, plane, limits);
  return fit;
}

}  // namespace lab::calibration
