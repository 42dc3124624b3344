#include "tracker_svc/calibration/camera_error_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace lab::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Variance [m^2] along a direction of the plane that corresponds to `sigma` [px].
double variance(const optics::PlaneScale& scale, const Eigen::Vector2d& along, double sigma) {
  Eigen::Matrix2d to_pixels;
  to_pixels << scale.ux, scale.uy, scale.vx, scale.vy;
  return sigma * sigma * (to_pixels.transpose().inverse() * along).squaredNorm();
}

}  // namespace

std::optional<double> spacingResidual(const optics::CameraModel& model,
                                      const optics::CapGeometry& cap,
                                      const CapObservation& observation) {
  const auto big = model.toPlane(observation.big, cap.height);
  const auto small = model.toPlane(observation.small, cap.height);
  if (!big || !small) return std::nullopt;
  return std::hypot(big->x - small->x, big->y - small->y) - cap.spacing();
}

std::optional<double> spacingSigma(const optics::CameraModel& model, const optics::CapGeometry& cap,
                                   const CapObservation& observation) {
  const auto big = model.toPlane(observation.big, cap.height);
  const auto small = model.toPlane(observation.small, cap.height);
  if (!big || !small) return std::nullopt;
  const Eigen::Vector2d along = Eigen::Vector2d(big->x - small->x, big->y - small->y).normalized();
  const double sigma2 = variance(model.scaleAt(*big, cap.height), along, observation.sigma) +
                        variance(model.scaleAt(*small, cap.height), along, observation.sigma);
  return sigma2 > 0 && std::isfinite(sigma2) ? std::optional(std::sqrt(sigma2)) : std::nullopt;
}

ErrorMap errorMap(const CameraState& state, const MatrixXd& covariance,
                  const CameraObservations& observations) {
  ErrorMap map;
  const auto count = static_cast<Index>(map.places.size());
  const optics::CameraModel model(state.camera);
  std::vector<optics::Pixel> pixels;
  for (int row = 0; row < ErrorMap::kRows; ++row) {
    for (int column = 0; column < ErrorMap::kColumns; ++column) {
      PlaceError& place = map.places[static_cast<std::size_t>(row * ErrorMap::kColumns + column)];
      place.x = observations.arena_width * column / (ErrorMap::kColumns - 1);
      place.y = observations.arena_height * row / (ErrorMap::kRows - 1);
      pixels.push_back(model.project(place.x, place.y, observations.cap.height));
    }
  }
  // The positions on the plane of fixed pixels, as a function of the unknowns.
  ResidualBlock block;
  for (int i = 0; i < kSpacing; ++i) block.unknowns.push_back(i);
  block.residuals = [&pixels, &observations](const CameraState& at) {
    const optics::CameraModel other(at.camera);
    VectorXd out(2 * static_cast<Index>(pixels.size()));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto place =
          other.toPlane(pixels[i], observations.cap.height).value_or(optics::Place{1e3, 1e3});
      out[2 * static_cast<Index>(i)] = place.x;
      out[2 * static_cast<Index>(i) + 1] = place.y;
    }
    return out;
  };
  const MatrixXd slopes = jacobianOf(block, state);
  const MatrixXd errors =
      slopes * covariance.topLeftCorner(kSpacing, kSpacing) * slopes.transpose();
  double sum = 0;
  for (Index i = 0; i < count; ++i) {
    const double of_place = errors(2 * i, 2 * i) + errors(2 * i + 1, 2 * i + 1);
    map.places[static_cast<std::size_t>(i)].frame = std::sqrt(of_place);
    map.largest = std::max(map.largest, std::sqrt(of_place));
    sum += of_place;
  }
  map.rms = std::sqrt(sum / static_cast<double>(count));

  // Projects out a common shift and rotation.
  MatrixXd rigid(2 * count, 3);
  for (Index i = 0; i < count; ++i) {
    const PlaceError& place = map.places[static_cast<std::size_t>(i)];
    rigid.row(2 * i) << 1, 0, -(place.y - observations.arena_height / 2);
    rigid.row(2 * i + 1) << 0, 1, place.x - observations.arena_width / 2;
  }
  const Eigen::Matrix3d normal = rigid.transpose() * rigid;
  const MatrixXd rest =
      MatrixXd::Identity(2 * count, 2 * count) - rigid * normal.inverse() * rigid.transpose();
  map.shape = std::sqrt((rest * errors * rest).trace() / static_cast<double>(count));
  return map;
}

void addSpacings(ErrorMap& map, const std::vector<SpacingAt>& spacings,
                 const CameraObservations& observations) {
  const auto nearest = [](double at, double length, int count) {
    return std::clamp(static_cast<int>(std::lround(at / length * (count - 1))), 0, count - 1);
  };
  std::array<double, ErrorMap::kColumns * ErrorMap::kRows> squares{};
  for (const SpacingAt& spacing : spacings) {
    const int column = nearest(spacing.place.x, observations.arena_width, ErrorMap::kColumns);
    const int row = nearest(spacing.place.y, observations.arena_height, ErrorMap::kRows);
    const auto index = static_cast<std::size_t>(row * ErrorMap::kColumns + column);
    map.places[index].caps += 1;
    map.places[index].spacing += spacing.residual;
    squares[index] += spacing.residual * spacing.residual;
  }
  for (std::size_t i = 0; i < map.places.size(); ++i) {
    PlaceError& place = map.places[i];
    if (place.caps == 0) continue;
    place.spacing /= place.caps;
    place.spacing_sigma = std::sqrt(squares[i]) / place.caps;
  }
}

}  // namespace lab::calibration
