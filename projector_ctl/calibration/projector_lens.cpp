#include "projector_ctl/calibration/projector_lens.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <utility>

namespace lab::calibration {
namespace {

using Eigen::VectorXd;

constexpr double kThrow = 2.0;  // [m] initial distance from the lens to the plane
constexpr double kFocalLength = 0.5;
constexpr double kSquare = 0.3;
constexpr double kMiddle = 1.0;
constexpr double kFirst = 2;
constexpr double kSecond = 10;
constexpr double kTangential = 0.1;
constexpr double kHeldAtZero = 1e-9;
constexpr double kCornerSigma = 1e-3;    // [px]
constexpr double kCornerMiss = 0.01;     // [px]
constexpr double kMostCornerMiss = 0.5;  // [px]
constexpr double kTilt = 0.3;            // [rad]

std::vector<int> lensUnknowns() {
  std::vector<int> all(kCameraUnknowns);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Depth of the arena's middle in front of the lens [m].
double throwOf(const optics::CameraParameters& lens, const ProjectorPlane& plane) {
  const auto& r = lens.rotation;
  return r[6] * plane.arena_width / 2 + r[7] * plane.arena_height / 2 + r[8] * plane.height +
         lens.translation[2];
}

/// Whether the corners turn in the same direction at each of them.
bool isConvex(const std::array<optics::Pixel, 4>& corners) {
  int left = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const optics::Pixel& a = corners[i];
    const optics::Pixel& b = corners[(i + 1) % 4];
    const optics::Pixel& c = corners[(i + 2) % 4];
    const double turn = (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
    if (!(std::abs(turn) > 0)) return false;
    left += turn > 0 ? 1 : -1;
  }
  return std::abs(left) == 4;
}

}  // namespace

std::optional<optics::CameraParameters> straightLens(
    const std::vector<ProjectorObservation>& observations, const ProjectorPlane& plane) {
  if (observations.size() < 3) return std::nullopt;
  const double middle_x = plane.arena_width / 2;
  const double middle_y = plane.arena_height / 2;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const ProjectorObservation& observation : observations) {
    const Eigen::Vector3d row(1, observation.place.x - middle_x, observation.place.y - middle_y);
    normal += row * row.transpose();
    right += row * Eigen::RowVector2d(observation.pixel.x, observation.pixel.y);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
  if (!solver.isInvertible()) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> affine = solver.solve(right);
  const Eigen::Vector2d along_u(affine(1, 0), affine(2, 0));  // [px/m] of the column
  const Eigen::Vector2d along_v(affine(1, 1), affine(2, 1));  // [px/m] of the row, downwards
  if (!(along_u.norm() > 0 && along_v.norm() > 0)) return std::nullopt;
  // Seen from above, v is 90 degrees clockwise from u, unless the light passes a mirror.
  const bool mirrored = along_u.x() * along_v.y() - along_u.y() * along_v.x() > 0;
  const double sign = mirrored ? -1 : 1;
  const Eigen::Vector2d from_v(-along_v.y(), along_v.x());
  const Eigen::Vector2d axis = (sign * along_u.normalized() + from_v.normalized()).normalized();
  optics::CameraParameters lens;
  lens.width = plane.columns;
  lens.height = plane.rows;
  lens.fx = sign * along_u.norm() * kThrow;
  lens.fy = along_v.norm() * kThrow;
  lens.cx = (plane.columns - 1) / 2.0;
  lens.cy = (plane.rows - 1) / 2.0;
  const double c = axis.x();
  const double s = axis.y();
  lens.rotation = {c, s, 0, s, -c, 0, 0, 0, -1};
  lens.translation = {(affine(0, 0) - lens.cx) / lens.fx * kThrow - c * middle_x - s * middle_y,
                      (affine(0, 1) - lens.cy) / lens.fy * kThrow - s * middle_x + c * middle_y,
                      kThrow + plane.height};
  return lens;
}

VectorXd pixelResiduals(const std::vector<ProjectorObservation>& observations,
                        const ProjectorPlane& plane, const optics::CameraParameters& lens) {
  const optics::CameraModel model(lens);
  VectorXd out(2 * static_cast<Eigen::Index>(observations.size()));
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const optics::Pixel fitted =
        model.project(observations[i].place.x, observations[i].place.y, plane.height);
    const auto row = 2 * static_cast<Eigen::Index>(i);
    out[row] = observations[i].pixel.x - fitted.x;
    out[row + 1] = observations[i].pixel.y - fitted.y;
  }
  return out;
}

ResidualBlock projectorPrior(const optics::CameraParameters& start, const ProjectorPlane& plane,
                             bool with_distortion) {
  const auto residuals = [start, plane, with_distortion](const CameraState& at) {
    const optics::CameraParameters& p = at.camera;
    const auto held = [&](double sigma) { return with_distortion ? sigma : kHeldAtZero; };
    VectorXd out(10);
    out << (p.fx / start.fx - 1) / kFocalLength, (p.fy / p.fx * start.fx / start.fy - 1) / kSquare,
        (p.cx - (plane.columns - 1) / 2.0) / (kMiddle * plane.columns),
        (p.cy - (plane.rows - 1) / 2.0) / (kMiddle * plane.rows), p.k1 / held(kFirst),
        p.k2 / held(kSecond), p.p1 / held(kTangential), p.p2 / held(kTangential),
        p.k3 / kHeldAtZero, (throwOf(p, plane) / throwOf(start, plane) - 1) / kFocalLength;
    return out;
  };
  const auto with_spacing = [residuals](const CameraState& at) -> VectorXd {
    VectorXd out(11);
    out << residuals(at), at.spacing;
    return out;
  };
  return {lensUnknowns(), with_spacing, false};
}

ResidualBlock observationBlock(const std::vector<ProjectorObservation>& observations,
                               const ProjectorPlane& plane, double noise, bool robust) {
  std::vector<int> unknowns = lensUnknowns();
  unknowns.resize(kSpacing);
  return {unknowns,
          [&observations, plane, noise](const CameraState& at) -> VectorXd {
            VectorXd out = pixelResiduals(observations, plane, at.camera);
            for (std::size_t i = 0; i < observations.size(); ++i) {
              out.segment<2>(2 * static_cast<Eigen::Index>(i)) /= noise * observations[i].sigma;
            }
            return out;
          },
          robust};
}

std::optional<optics::CameraParameters> lensFromCorners(const std::array<optics::Pixel, 4>& corners,
                                                        const ProjectorPlane& plane) {
  if (!isConvex(corners)) return std::nullopt;
  const double w = plane.arena_width;
  const double h = plane.arena_height;
  const std::vector<ProjectorObservation> observations = {{{0, 0}, corners[0], kCornerSigma},
                                                          {{w, 0}, corners[1], kCornerSigma},
                                                          {{w, h}, corners[2], kCornerSigma},
                                                          {{0, h}, corners[3], kCornerSigma}};
  const auto start = straightLens(observations, plane);
  if (!start) return std::nullopt;
  CameraState state;
  state.camera = *start;
  state.pivot = {w / 2, h / 2, plane.height};
  std::optional<optics::CameraParameters> best;
  double least = kMostCornerMiss;
  // With a strong keystone the search from straight above may end in a local minimum: then starts
  // from the sides.
  for (const auto& [x, y] :
       {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
    const CameraSolution solution = solveCamera(
        {observationBlock(observations, plane, 1, false), projectorPrior(*start, plane, false)},
        state.moved(kTurn, kTilt * x).moved(kTurn + 1, kTilt * y));
    optics::CameraParameters lens = solution.state.camera;
    lens.k1 = lens.k2 = lens.p1 = lens.p2 = lens.k3 = 0;
    const double miss = pixelResiduals(observations, plane, lens).cwiseAbs().maxCoeff();
    if (miss < least) {
      least = miss;
      best = lens;
    }
    if (miss < kCornerMiss) break;
  }
  return best;
}

}  // namespace lab::calibration
