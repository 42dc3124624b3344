#include "tracker_svc/calibration/camera_fit_start.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace lab::calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double cross(const optics::Pixel& a, const optics::Pixel& b, const optics::Pixel& c) {
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

double distance(const optics::Pixel& a, const optics::Pixel& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

/// A camera looking straight down from `height`, rotated and shifted to fit the corners.
optics::CameraParameters straightDown(const CameraObservations& observations, double height) {
  optics::CameraParameters p;
  p.width = observations.width;
  p.height = observations.height;
  p.cx = (observations.width - 1) / 2.0;
  p.cy = (observations.height - 1) / 2.0;
  const auto& c = observations.corners;
  const double scale = (distance(c[0], c[1]) / observations.arena_width +
                        distance(c[1], c[2]) / observations.arena_height +
                        distance(c[2], c[3]) / observations.arena_width +
                        distance(c[3], c[0]) / observations.arena_height) /
                       4;
  p.fx = p.fy = scale * height;
  // Direction of x in the picture, from both long sides; the arena's y points up in the picture.
  const double angle =
      std::atan2(c[1].y - c[0].y + c[2].y - c[3].y, c[1].x - c[0].x + c[2].x - c[3].x);
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  p.rotation = {cosine, sine, 0, sine, -cosine, 0, 0, 0, -1};
  const double u = (c[0].x + c[1].x + c[2].x + c[3].x) / 4;
  const double v = (c[0].y + c[1].y + c[2].y + c[3].y) / 4;
  const double x = observations.arena_width / 2;
  const double y = observations.arena_height / 2;
  p.translation = {(u - p.cx) / scale - (cosine * x + sine * y),
                   (v - p.cy) / scale - (sine * x - cosine * y), height};
  return p;
}

}  // namespace

std::string cornerFault(const Corners& corners, int width, int height, double arena_width,
                        double arena_height) {
  int left_turns = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const optics::Pixel& c = corners[i];
    if (!(c.x > -0.5 * width && c.x < 1.5 * width && c.y > -0.5 * height && c.y < 1.5 * height)) {
      return fmt::format("corner {}: found {:g},{:g} px, the pictures have {} x {}", i + 1, c.x,
                         c.y, width, height);
    }
    left_turns += cross(c, corners[(i + 1) % 4], corners[(i + 2) % 4]) < 0 ? 1 : 0;
  }
  constexpr const char* kOrder =
      "expected (0, 0), (width, 0), (width, height), (0, height) of the arena, counter-clockwise "
      "as "
      "seen from above";
  if (left_turns == 0) {
    return fmt::format("corners: found them clockwise in the picture, {}; or is it mirrored?",
                       kOrder);
  }
  if (left_turns != 4) return fmt::format("corners: found sides that cross, {}", kOrder);
  const double ratio = (distance(corners[0], corners[1]) + distance(corners[2], corners[3])) /
                       (distance(corners[1], corners[2]) + distance(corners[3], corners[0]));
  const double expected = arena_width / arena_height;
  if (std::abs(std::log(ratio / expected)) > std::log(1.2)) {
    return fmt::format(
        "corners: found sides of {:.2f} : 1, expected {:.2f} : 1; do they begin at "
        "(0, 0), and is --arena-cm right?",
        ratio, expected);
  }
  return {};
}

std::optional<Matrix3d> homographyOf(const std::vector<BoardPoint>& points) {
  if (points.size() < 6) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  for (const BoardPoint& p : points)
    mean += Eigen::Vector4d(p.x, p.y, p.pixel.x, p.pixel.y) / count;
  double board = 0;
  double picture = 0;
  for (const BoardPoint& p : points) {
    board += std::hypot(p.x - mean[0], p.y - mean[1]) / count;
    picture += std::hypot(p.pixel.x - mean[2], p.pixel.y - mean[3]) / count;
  }
  if (!(board > 0) || !(picture > 0)) return std::nullopt;
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(points.size()), 9);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::RowVector3d at((points[i].x - mean[0]) / board, (points[i].y - mean[1]) / board,
                                1);
    const double u = (points[i].pixel.x - mean[2]) / picture;
    const double v = (points[i].pixel.y - mean[3]) / picture;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    rows.row(row) << at, Eigen::RowVector3d::Zero(), -u * at;
    rows.row(row + 1) << Eigen::RowVector3d::Zero(), at, -v * at;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeFullV);
  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  Matrix3d normalised;
  normalised << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  Matrix3d from_board;
  from_board << 1 / board, 0, -mean[0] / board, 0, 1 / board, -mean[1] / board, 0, 0, 1;
  Matrix3d to_picture;
  to_picture << picture, 0, mean[2], 0, picture, mean[3], 0, 0, 1;
  return to_picture * normalised * from_board;
}

std::optional<double> focalLengthOf(const std::vector<Matrix3d>& homographies, int width,
                                    int height) {
  // With the principal point subtracted, the first two columns of K^-1 H have equal lengths and are
  // orthogonal: two equations for 1 / f^2 each.
  Matrix3d centred = Matrix3d::Identity();
  centred(0, 2) = -(width - 1) / 2.0;
  centred(1, 2) = -(height - 1) / 2.0;
  double with = 0;
  double against = 0;
  for (const Matrix3d& homography : homographies) {
    Matrix3d h = centred * homography;
    h /= h.leftCols<2>().norm();
    const Vector3d a = h.col(0);
    const Vector3d b = h.col(1);
    const double of_angle = a[0] * b[0] + a[1] * b[1];
    const double of_length = a[0] * a[0] + a[1] * a[1] - b[0] * b[0] - b[1] * b[1];
    const double angle = a[2] * b[2];
    const double length = a[2] * a[2] - b[2] * b[2];
    with += of_angle * of_angle + of_length * of_length;
    against -= of_angle * angle + of_length * length;
  }
  if (!(with > 0) || !(against > 0)) return std::nullopt;
  return std::sqrt(with / against);
}

BoardPose boardPose(const Matrix3d& homography, const optics::CameraParameters& camera) {
  Matrix3d inverse_k;
  inverse_k << 1 / camera.fx, 0, -camera.cx / camera.fx, 0, 1 / camera.fy, -camera.cy / camera.fy,
      0, 0, 1;
  Matrix3d h = inverse_k * homography;
  h /= std::sqrt(h.col(0).norm() * h.col(1).norm());
  if (h(2, 2) < 0) h = -h;  // the board is in front of the camera
  Matrix3d rotation;
  rotation << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU() * svd.matrixV().transpose(), h.col(2)};
}

optics::CameraParameters guessFromCorners(const CameraObservations& observations,
                                          double camera_height, double k1) {
  if (!(camera_height > 0)) {
    camera_height = 1.4 * std::max(observations.arena_width, observations.arena_height);
  }
  CameraState state;
  state.camera = straightDown(observations, camera_height);
  state.camera.k1 = k1;
  state.pivot = {observations.arena_width / 2, observations.arena_height / 2, 0};
  ResidualBlock corners;
  for (int i = 0; i < kSpacing; ++i) corners.unknowns.push_back(i);
  corners.residuals = [&observations](const CameraState& at) {
    const optics::CameraModel model(at.camera);
    const double w = observations.arena_width;
    const double h = observations.arena_height;
    const std::array<optics::Place, 4> places = {{{0, 0}, {w, 0}, {w, h}, {0, h}}};
    Eigen::VectorXd out(8);
    for (std::size_t i = 0; i < 4; ++i) {
      const optics::Pixel seen = model.project(places[i].x, places[i].y, 0);
      const auto row = 2 * static_cast<Eigen::Index>(i);
      out[row] = seen.x - observations.corners[i].x;
      out[row + 1] = seen.y - observations.corners[i].y;
    }
    return out;
  };
  ResidualBlock held;
  for (int i = 0; i < kCameraUnknowns; ++i) held.unknowns.push_back(i);
  const optics::CameraParameters began = state.camera;
  held.residuals = [began, camera_height](const CameraState& at) {
    constexpr double kHeld = 1e-4;
    const optics::CameraParameters& p = at.camera;
    Eigen::VectorXd out(10);
    out << (p.fy / p.fx - 1) / kHeld, p.cx - began.cx, p.cy - began.cy, (p.k1 - began.k1) / kHeld,
        p.k2 / kHeld, p.p1 / kHeld, p.p2 / kHeld, p.k3 / kHeld, at.spacing / kHeld,
        (optics::CameraModel(p).centre()[2] / camera_height - 1) / kHeld;
    return out;
  };
  return solveCamera({corners, held}, state).state.camera;
}

}  // namespace lab::calibration
