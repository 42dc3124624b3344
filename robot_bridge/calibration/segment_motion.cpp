#include "robot_bridge/calibration/segment_motion.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <complex>

#include "common/math/angle.hpp"

namespace lab::calibration {
namespace {

using Complex = std::complex<double>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Parameters: position, velocity and heading in the middle of the time, and turning rate.
enum Parameter { kX, kY, kVelocityX, kVelocityY, kHeading, kTurn };

constexpr int kIterations = 10;
constexpr double kSmallAngle = 1e-3;

/// The integral of e^(i w s) from 0 to t, and its derivative with respect to w.
struct Arc {
  Complex value;
  Complex by_turn;
};

Arc arcOf(double turn, double t) {
  const double h = turn * t / 2;
  const bool small = std::fabs(h) < kSmallAngle;
  const double sinc = small ? 1 - h * h / 6 : std::sin(h) / h;
  const double sinc_slope = small ? -h / 3 : (std::cos(h) - sinc) / h;
  const Complex direction = std::polar(1.0, h);
  return {t * sinc * direction, t * t / 2 * (sinc_slope + Complex(0, 1) * sinc) * direction};
}

std::vector<TrackPoint> centred(std::vector<TrackPoint> track) {
  const double middle = (track.front().time + track.back().time) / 2;
  double previous = track.front().theta;
  for (TrackPoint& point : track) {
    point.time -= middle;
    point.theta = previous + wrapAngle(point.theta - previous);
    previous = point.theta;
  }
  return track;
}

/// Start values: a straight line through the headings, and the velocity fitted to the positions
/// with this turning rate.
Vector6 firstGuess(const std::vector<TrackPoint>& track) {
  double n = 0, t = 0, tt = 0, theta = 0, theta_t = 0;
  for (const TrackPoint& point : track) {
    n += 1;
    t += point.time;
    tt += point.time * point.time;
    theta += point.theta;
    theta_t += point.theta * point.time;
  }
  const double turn = (n * theta_t - t * theta) / (n * tt - t * t);
  // z = z0 + k F: linear in the complex z0 and k.
  Complex f = 0, z = 0, fz = 0;
  double ff = 0;
  for (const TrackPoint& point : track) {
    const Complex arc = arcOf(turn, point.time).value;
    const Complex place(point.x, point.y);
    f += arc;
    z += place;
    fz += std::conj(arc) * place;
    ff += std::norm(arc);
  }
  const Complex k = (n * fz - std::conj(f) * z) / (n * ff - std::norm(f));
  const Complex z0 = (z - k * f) / n;
  Vector6 guess;
  guess << z0.real(), z0.imag(), k.real(), k.imag(), (theta - turn * t) / n, turn;
  return guess;
}

/// The normal equations at `p`, and the squares of the residuals.
struct Equations {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double position_squares = 0;
  double heading_squares = 0;
};

Equations equationsAt(const Vector6& p, const std::vector<TrackPoint>& track,
                      const TrackNoise& noise) {
  Equations equations;
  const Complex velocity(p[kVelocityX], p[kVelocityY]);
  const double position_weight = 1 / (noise.position * noise.position);
  const double heading_weight = 1 / (noise.heading * noise.heading);
  for (const TrackPoint& point : track) {
    const Arc arc = arcOf(p[kTurn], point.time);
    const Complex moved = velocity * arc.value;
    const Complex by_turn = velocity * arc.by_turn;
    Eigen::Matrix<double, 3, 6> slopes = Eigen::Matrix<double, 3, 6>::Zero();
    slopes.row(0) << 1, 0, arc.value.real(), -arc.value.imag(), 0, by_turn.real();
    slopes.row(1) << 0, 1, arc.value.imag(), arc.value.real(), 0, by_turn.imag();
    slopes.row(2) << 0, 0, 0, 0, 1, point.time;
    const Eigen::Vector3d residual(point.x - p[kX] - moved.real(), point.y - p[kY] - moved.imag(),
                                   point.theta - p[kHeading] - p[kTurn] * point.time);
    const Eigen::Vector3d weight(position_weight, position_weight, heading_weight);
    equations.information += slopes.transpose() * weight.asDiagonal() * slopes;
    equations.gradient += slopes.transpose() * weight.asDiagonal() * residual;
    equations.position_squares += residual.head<2>().squaredNorm();
    equations.heading_squares += residual[2] * residual[2];
  }
  return equations;
}

}  // namespace

std::optional<SegmentMotion> fitMotion(const std::vector<TrackPoint>& track,
                                       const TrackNoise& noise) {
  if (track.size() < kFewestPoints || track.back().time <= track.front().time) return {};
  const std::vector<TrackPoint> points = centred(track);
  Vector6 p = firstGuess(points);
  for (int i = 0; i < kIterations; ++i) {
    const Equations equations = equationsAt(p, points, noise);
    const Vector6 step = equations.information.ldlt().solve(equations.gradient);
    p += step;
    if (std::fabs(step[kTurn]) < 1e-9) break;
  }
  const Equations equations = equationsAt(p, points, noise);
  const Matrix6 covariance = equations.information.ldlt().solve(Matrix6::Identity());

  // speed = velocity along the heading
  const double c = std::cos(p[kHeading]);
  const double s = std::sin(p[kHeading]);
  SegmentMotion motion;
  motion.value << p[kVelocityX] * c + p[kVelocityY] * s, p[kTurn];
  Eigen::Matrix<double, 2, 6> slopes = Eigen::Matrix<double, 2, 6>::Zero();
  slopes(0, kVelocityX) = c;
  slopes(0, kVelocityY) = s;
  slopes(0, kHeading) = p[kVelocityY] * c - p[kVelocityX] * s;
  slopes(1, kTurn) = 1;
  motion.covariance = slopes * covariance * slopes.transpose();
  motion.position_squares = equations.position_squares;
  motion.heading_squares = equations.heading_squares;
  motion.points = static_cast<int>(points.size());
  if (!motion.value.allFinite() || !motion.covariance.allFinite()) return {};
  return motion;
}

}  // namespace lab::calibration
