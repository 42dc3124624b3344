#include "tracker_svc/calibration/camera_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "light/median.hpp"
#include "light/optics/bundle_adjustment.hpp"
#include "tracker_svc/calibration/camera_error_map.hpp"
#include "tracker_svc/calibration/camera_fit_start.hpp"
#include "tracker_svc/calibration/camera_fit_verdict.hpp"

namespace lab::calibration {
namespace {

using Eigen::VectorXd;

constexpr int kRounds = 4;       // each fits the camera, then estimates the noise
constexpr double kOutlying = 5;  // [standard deviations]
// [standard deviations] residual of a cap that the camera of this step of the fit cannot see
constexpr double kOutOfView = 100;
// standard deviation of a normal variate over the median of its absolute value
constexpr double kNormalMedian = 1.4826;
constexpr double kLeastNoise = 0.1;  // smallest noise, in units of the given sigma

// Standard deviations of the priors: see camera_fit.hpp.
constexpr double kSquare = 0.002;     // [1] fy / fx - 1
constexpr double kMiddle = 0.02;      // [picture width] cx, cy from the middle
constexpr double kTangential = 1e-3;  // [1] p1, p2
constexpr double kSecond = 0.3;       // [1] k2, and k3 if it is fitted
constexpr double kCapMake = 5e-4;     // [1] scale of the caps
constexpr double kHeldAtZero = 1e-9;  // [1] k3 if it is not fitted

std::vector<int> upTo(int end) {
  std::vector<int> all(static_cast<std::size_t>(end));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::array<optics::Place, 4> cornersOf(const CameraObservations& observations) {
  const double w = observations.arena_width;
  const double h = observations.arena_height;
  return {{{0, 0}, {w, 0}, {w, h}, {0, h}}};
}

/// Projected minus marked [px]. The signs of residuals do not matter to the fit.
VectorXd cornerResiduals(const CameraObservations& observations,
                         const optics::CameraParameters& camera) {
  const optics::CameraModel model(camera);
  const auto places = cornersOf(observations);
  VectorXd out(8);
  for (std::size_t i = 0; i < 4; ++i) {
    const optics::Pixel projected = model.project(places[i].x, places[i].y, 0);
    const auto row = 2 * static_cast<Eigen::Index>(i);
    out[row] = projected.x - observations.corners[i].x;
    out[row + 1] = projected.y - observations.corners[i].y;
  }
  return out;
}

ResidualBlock cornerBlock(const CameraObservations& observations) {
  return {upTo(kSpacing),
          [&observations](const CameraState& at) -> VectorXd {
            return cornerResiduals(observations, at.camera) / observations.corner_sigma;
          },
          false};
}

ResidualBlock priorBlock(const CameraObservations& observations) {
  const auto residuals = [&observations](const CameraState& at) {
    const optics::CameraParameters& p = at.camera;
    const double middle = kMiddle * observations.width;
    VectorXd out(9);
    out << (p.fy / p.fx - 1) / kSquare, (p.cx - (observations.width - 1) / 2.0) / middle,
        (p.cy - (observations.height - 1) / 2.0) / middle, p.p1 / kTangential, p.p2 / kTangential,
        p.k2 / kSecond, p.k3 / (observations.with_k3 ? kSecond : kHeldAtZero),
        at.spacing / kCapMake, heightResidual(observations, p);
    return out;
  };
  return {upTo(kCameraUnknowns), residuals, false};
}

/// One cap, and the standard error of its spacing.
struct WeighedCap {
  CapObservation ellipses;  // centres of the ellipses
  CapObservation centres;   // centres of the circles
  double sigma = 0;         // [m]
};

ResidualBlock capBlock(const CameraObservations& observations, const std::vector<WeighedCap>& caps,
                       double noise) {
  const auto residuals = [&observations, &caps, noise](const CameraState& at) {
    const optics::CameraModel model(at.camera);
    VectorXd out(static_cast<Eigen::Index>(caps.size()));
    for (std::size_t i = 0; i < caps.size(); ++i) {
      const std::optional<double> residual =
          spacingResidual(model, observations.cap, caps[i].centres);
      out[static_cast<Eigen::Index>(i)] =
          residual ? (*residual - at.spacing * observations.cap.spacing()) / (noise * caps[i].sigma)
                   : kOutOfView;
    }
    return out;
  };
  return {upTo(kCameraUnknowns), residuals, true};
}

/// A circle on the plane appears as an ellipse whose centre is not the image of the circle's
/// centre. This function returns the centre of the ellipse, exact to order R^2 (R: the radius).
///
/// The inverse of the derivatives at the circle's centre transforms the outline back to the plane.
/// The result is a circle whose point in direction e (a unit vector) is displaced along axis i by
/// R^2/2 e^T H_i e. H_i is the matrix of the second derivatives of coordinate i of the transformed
/// image. So the centre of the best fit is displaced along axis i by
/// R^2/8 (trace H_i + 2 sum_k H_k(k, i)).
optics::Pixel discCentre(const optics::CameraModel& model, double x, double y, double z,
                         double radius) {
  constexpr double kStep = 0.005;  // [m]
  optics::PlaneScale scale;
  const optics::Pixel middle = model.project(x, y, z, scale);
  Eigen::Matrix2d forward;
  forward << scale.ux, scale.uy, scale.vx, scale.vy;
  const Eigen::Matrix2d inverse = forward.inverse();
  const auto second = [&](double dx, double dy) {
    const optics::PlaneScale more = model.scaleAt({x + dx, y + dy}, z);
    const optics::PlaneScale less = model.scaleAt({x - dx, y - dy}, z);
    Eigen::Matrix2d slope;  // derivative of the derivatives by x or y, in units of the plane
    slope << more.ux - less.ux, more.uy - less.uy, more.vx - less.vx, more.vy - less.vy;
    return Eigen::Matrix2d(inverse * slope / (2 * kStep));
  };
  const Eigen::Matrix2d by_x = second(kStep, 0);
  const Eigen::Matrix2d by_y = second(0, kStep);
  const Eigen::Vector2d trace(by_x(0, 0) + by_y(0, 1), by_x(1, 0) + by_y(1, 1));
  const Eigen::Vector2d divergence(by_x(0, 0) + by_x(1, 1), by_y(0, 0) + by_y(1, 1));
  const Eigen::Vector2d moved = forward * (trace + 2 * divergence) * (radius * radius / 8);
  return {middle.x + moved[0], middle.y + moved[1]};
}

/// Projected minus measured [px] of every disc of one board.
VectorXd boardResiduals(const BoardView& board, const CameraState& at, std::size_t index) {
  optics::CameraParameters p = at.camera;
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(p.rotation.data()) = at.boards[index].rotation;
  Eigen::Map<Eigen::Vector3d>(p.translation.data()) = at.boards[index].translation;
  const optics::CameraModel model(p);
  VectorXd out(2 * static_cast<Eigen::Index>(board.points.size()));
  for (std::size_t i = 0; i < board.points.size(); ++i) {
    const BoardPoint& point = board.points[i];
    const optics::Pixel projected = discCentre(model, point.x, point.y, 0, board.disc_radius);
    const auto row = 2 * static_cast<Eigen::Index>(i);
    out[row] = projected.x - point.pixel.x;
    out[row + 1] = projected.y - point.pixel.y;
  }
  return out;
}

VectorXd boardSigmas(const BoardView& board) {
  VectorXd out(2 * static_cast<Eigen::Index>(board.points.size()));
  for (std::size_t i = 0; i < board.points.size(); ++i) {
    out.segment<2>(2 * static_cast<Eigen::Index>(i)).setConstant(board.points[i].sigma);
  }
  return out;
}

ResidualBlock boardBlock(const BoardView& board, std::size_t index, double noise) {
  std::vector<int> unknowns = upTo(kTurn);
  for (int i = 0; i < 6; ++i) {
    unknowns.push_back(kCameraUnknowns + 6 * static_cast<int>(index) + i);
  }
  return {unknowns,
          [&board, index, noise](const CameraState& at) -> VectorXd {
            return boardResiduals(board, at, index).cwiseQuotient(noise * boardSigmas(board));
          },
          true};
}

/// Standard deviation from the median of the absolute residuals, which a few outliers hardly
/// change. `freedom` is the share of degrees of freedom that the fit leaves.
double robustSigma(std::vector<double> sizes, double freedom) {
  if (sizes.empty()) return 1;
  return std::max(kNormalMedian * medianOf(sizes) / std::sqrt(std::max(0.05, freedom)),
                  kLeastNoise);
}

/// The image of a circle's centre, from the centre of its ellipse.
optics::Pixel circleCentre(const optics::CameraModel& model, const optics::CapGeometry& cap,
                           const optics::Pixel& ellipse, double radius) {
  const auto place = model.toPlane(ellipse, cap.height);
  if (!place) return ellipse;
  const optics::Pixel middle = model.project(place->x, place->y, cap.height);
  const optics::Pixel projected = discCentre(model, place->x, place->y, cap.height, radius);
  return {ellipse.x - (projected.x - middle.x), ellipse.y - (projected.y - middle.y)};
}

std::vector<WeighedCap> weighed(const CameraObservations& observations,
                                const optics::CameraParameters& camera,
                                const std::vector<CapObservation>& caps) {
  const optics::CameraModel model(camera);
  std::vector<WeighedCap> out;
  for (const CapObservation& observation : caps) {
    CapObservation centres = observation;
    centres.big =
        circleCentre(model, observations.cap, observation.big, observations.cap.big_radius);
    centres.small =
        circleCentre(model, observations.cap, observation.small, observations.cap.small_radius);
    const auto sigma = spacingSigma(model, observations.cap, centres);
    if (sigma) out.push_back({observation, centres, *sigma});
  }
  return out;
}

double rms(const VectorXd& values) {
  return values.size() == 0 ? 0
                            : std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

CameraState startFrom(const CameraObservations& observations,
                      const std::optional<optics::CameraParameters>& start) {
  CameraState state;
  state.pivot = {observations.arena_width / 2, observations.arena_height / 2, 0};
  std::vector<Eigen::Matrix3d> homographies;
  for (const BoardView& board : observations.boards) {
    homographies.push_back(homographyOf(board.points).value_or(Eigen::Matrix3d::Identity()));
  }
  if (start) {
    state.camera = *start;
  } else {
    state.camera = guessFromCorners(observations);
    if (const auto focal = focalLengthOf(homographies, observations.width, observations.height)) {
      const double height = optics::CameraModel(state.camera).centre()[2];
      const double ratio = std::clamp(*focal / state.camera.fx, 0.2, 5.0);
      state.camera = guessFromCorners(observations, ratio * height);
    }
  }
  for (const Eigen::Matrix3d& h : homographies) state.boards.push_back(boardPose(h, state.camera));
  return state;
}

/// Intermediate results.
struct Fitted {
  CameraSolution solution;
  std::vector<WeighedCap> caps;
  double noise = 1;  // of the caps, in units of their sigma
  double board_noise = 1;
  int outlying = 0;
};

std::vector<ResidualBlock> blocksOf(const CameraObservations& observations, const Fitted& fitted) {
  std::vector<ResidualBlock> blocks = {cornerBlock(observations), priorBlock(observations)};
  if (!fitted.caps.empty()) blocks.push_back(capBlock(observations, fitted.caps, fitted.noise));
  for (std::size_t i = 0; i < observations.boards.size(); ++i) {
    blocks.push_back(boardBlock(observations.boards[i], i, fitted.board_noise));
  }
  return blocks;
}

void estimateNoise(const CameraObservations& observations, Fitted& fitted) {
  const CameraState& state = fitted.solution.state;
  std::vector<double> sizes;
  if (!fitted.caps.empty()) {
    const VectorXd residuals = capBlock(observations, fitted.caps, 1).residuals(state);
    for (const double residual : residuals) sizes.push_back(std::abs(residual));
    const auto count = static_cast<double>(sizes.size());
    // The caps determine about nine unknowns; with boards three: the height and the two tilts.
    fitted.noise = robustSigma(sizes, (count - (observations.boards.empty() ? 9 : 3)) / count);
  }
  sizes.clear();
  for (std::size_t i = 0; i < observations.boards.size(); ++i) {
    const VectorXd residuals = boardBlock(observations.boards[i], i, 1).residuals(state);
    for (const double residual : residuals) sizes.push_back(std::abs(residual));
  }
  const auto count = static_cast<double>(sizes.size());
  // Unknowns: fx, fy, cx, cy, k1, k2, p1, p2, and the six of each board's pose.
  const double used = 8 + 6 * static_cast<double>(observations.boards.size());
  fitted.board_noise = robustSigma(sizes, (count - used) / count);
}

Fitted fitAll(const CameraObservations& observations, const CameraState& start) {
  Fitted fitted;
  fitted.solution.state = start;
  std::vector<CapObservation> observed_caps = observations.caps;
  // Large: the start may be poor, and a residual of many standard deviations would lose its weight.
  fitted.noise = 10;
  fitted.board_noise = 10;
  for (int round = 0; round < kRounds; ++round) {
    fitted.caps = weighed(observations, fitted.solution.state.camera, observed_caps);
    fitted.solution = solveCamera(blocksOf(observations, fitted), fitted.solution.state);
    estimateNoise(observations, fitted);
    if (round + 2 != kRounds || fitted.caps.empty()) continue;
    // The last round fits without the outliers of the round before.
    const VectorXd residuals =
        capBlock(observations, fitted.caps, fitted.noise).residuals(fitted.solution.state);
    observed_caps.clear();
    for (std::size_t i = 0; i < fitted.caps.size(); ++i) {
      if (std::abs(residuals[static_cast<Eigen::Index>(i)]) < kOutlying) {
        observed_caps.push_back(fitted.caps[i].ellipses);
      }
    }
  }
  fitted.outlying = static_cast<int>(observations.caps.size() - fitted.caps.size());
  return fitted;
}

optics::CameraParameters errorsOf(const Eigen::MatrixXd& covariance) {
  const VectorXd sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  optics::CameraParameters error;
  error.fx = sigma[kFx];
  error.fy = sigma[kFy];
  error.cx = sigma[kCx];
  error.cy = sigma[kCy];
  error.k1 = sigma[kK1];
  error.k2 = sigma[kK2];
  error.p1 = sigma[kP1];
  error.p2 = sigma[kP2];
  error.k3 = sigma[kK3];
  return error;
}

/// Sets the standard errors of the camera's position: of its height and of its foot on the floor.
void placeErrors(const CameraState& state, const Eigen::MatrixXd& covariance, CameraFit& fit) {
  ResidualBlock block;
  block.unknowns = upTo(kCameraUnknowns);
  block.residuals = [](const CameraState& at) -> VectorXd {
    const auto centre = optics::CameraModel(at.camera).centre();
    return Eigen::Vector3d(centre[0], centre[1], centre[2]);
  };
  const Eigen::MatrixXd slopes = jacobianOf(block, state);
  const Eigen::Matrix3d errors =
      slopes * covariance.topLeftCorner(kCameraUnknowns, kCameraUnknowns) * slopes.transpose();
  fit.height_error = std::sqrt(errors(2, 2));
  fit.foot_error = std::sqrt(errors(0, 0) + errors(1, 1));
}

CameraFit summary(const CameraObservations& observations, const Fitted& fitted) {
  const CameraState& state = fitted.solution.state;
  CameraFit fit;
  fit.camera = state.camera;
  fit.camera.width = observations.width;
  fit.camera.height = observations.height;
  fit.height = optics::CameraModel(state.camera).centre()[2];
  fit.caps = static_cast<int>(fitted.caps.size());
  fit.outlying = fitted.outlying;
  fit.corner_residual = rms(cornerResiduals(observations, state.camera));
  VectorXd residuals(0);
  if (!fitted.caps.empty()) {
    std::vector<double> sigmas;
    residuals = capBlock(observations, fitted.caps, 1).residuals(state);
    for (std::size_t i = 0; i < fitted.caps.size(); ++i) {
      residuals[static_cast<Eigen::Index>(i)] *= fitted.caps[i].sigma;
      sigmas.push_back(fitted.caps[i].ellipses.sigma);
    }
    fit.cap_noise = fitted.noise * medianOf(sigmas);
    fit.spacing_residual = rms(residuals);
  }
  VectorXd all(0);
  for (std::size_t i = 0; i < observations.boards.size(); ++i) {
    const VectorXd more = boardResiduals(observations.boards[i], state, i);
    VectorXd joined(all.size() + more.size());
    joined << all, more;
    all = joined;
  }
  fit.board_residual = rms(all);
  if (!fitted.solution.determined) return fit;
  fit.error = errorsOf(fitted.solution.covariance);
  placeErrors(state, fitted.solution.covariance, fit);
  fit.map = errorMap(state, fitted.solution.covariance, observations);
  std::vector<SpacingAt> spacings;
  const optics::CameraModel model(state.camera);
  for (std::size_t i = 0; i < fitted.caps.size(); ++i) {
    const CapObservation& observation = fitted.caps[i].centres;
    const auto place = model.toPlane(observation.big, observations.cap.height);
    if (place) spacings.push_back({*place, residuals[static_cast<Eigen::Index>(i)]});
  }
  addSpacings(fit.map, spacings, observations);
  return fit;
}

}  // namespace

CameraFit fitCamera(const CameraObservations& observations,
                    const std::optional<optics::CameraParameters>& start,
                    const CameraFitLimits& limits) {
  CameraFit fit;
  fit.refusal = cornerFault(observations.corners, observations.width, observations.height,
                            observations.arena_width, observations.arena_height);
  if (!fit.refusal.empty()) return fit;
  const CameraState begin = startFrom(observations, start);
  if (observations.boards.empty()) fit.refusal = coverageFault(observations, begin.camera, limits);
  if (!fit.refusal.empty()) return fit;
  const Fitted fitted = fitAll(observations, begin);
  fit = summary(observations, fitted);
  fit.refusal = fitted.solution.determined
                    ? refusalOf(observations, fit, limits)
                    : "these data do not determine the camera: more caps all over the arena, or "
                      "pictures of a board in several poses, are needed";
  return fit;
}

}  // namespace lab::calibration
