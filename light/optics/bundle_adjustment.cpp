#include "light/optics/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace lab::calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kIterations = 100;
constexpr double kConverged = 1e-10;  // of the cost, relative
constexpr double kHuber = 2;          // standard deviations from which residuals count linearly
constexpr double kSingular = 1e-14;

Matrix3d turned(const Vector3d& by, const Matrix3d& rotation) {
  const double angle = by.norm();
  if (angle <= 0) return rotation;
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() * rotation;
}

struct Equations {
  MatrixXd information;
  VectorXd gradient;
};

double huberCost(double residual) {
  const double size = std::abs(residual);
  return size <= kHuber ? residual * residual : kHuber * (2 * size - kHuber);
}

double costOf(const std::vector<ResidualBlock>& blocks, const CameraState& state) {
  double cost = 0;
  for (const ResidualBlock& block : blocks) {
    const VectorXd residuals = block.residuals(state);
    cost += block.robust ? residuals.unaryExpr(&huberCost).sum() : residuals.squaredNorm();
  }
  return std::isfinite(cost) ? cost : HUGE_VAL;
}

Equations equationsAt(const std::vector<ResidualBlock>& blocks, const CameraState& state) {
  const int unknowns = state.unknowns();
  Equations equations{MatrixXd::Zero(unknowns, unknowns), VectorXd::Zero(unknowns)};
  for (const ResidualBlock& block : blocks) {
    const MatrixXd slopes = jacobianOf(block, state);
    const VectorXd residuals = block.residuals(state);
    VectorXd weights = VectorXd::Ones(residuals.size());
    if (block.robust) weights = kHuber / residuals.cwiseAbs().cwiseMax(kHuber).array();
    const MatrixXd information = slopes.transpose() * weights.asDiagonal() * slopes;
    const VectorXd gradient = slopes.transpose() * weights.cwiseProduct(residuals);
    for (std::size_t i = 0; i < block.unknowns.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      equations.gradient[block.unknowns[i]] -= gradient[row];
      for (std::size_t j = 0; j < block.unknowns.size(); ++j) {
        equations.information(block.unknowns[i], block.unknowns[j]) +=
            information(row, static_cast<Eigen::Index>(j));
      }
    }
  }
  return equations;
}

}  // namespace

CameraState CameraState::moved(const VectorXd& by) const {
  CameraState next = *this;
  optics::CameraParameters& p = next.camera;
  p.fx += by[kFx];
  p.fy += by[kFy];
  p.cx += by[kCx];
  p.cy += by[kCy];
  p.k1 += by[kK1];
  p.k2 += by[kK2];
  p.p1 += by[kP1];
  p.p2 += by[kP2];
  p.k3 += by[kK3];
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Matrix3d old = Eigen::Map<const RowMajor>(camera.rotation.data());
  const Vector3d at = old * pivot + Vector3d(camera.translation.data());
  const Matrix3d rotation = turned(by.segment<3>(kTurn), old);
  Eigen::Map<RowMajor>(p.rotation.data()) = rotation;
  Eigen::Map<Vector3d>(p.translation.data()) = at + by.segment<3>(kShift) - rotation * pivot;
  next.spacing += by[kSpacing];
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(kCameraUnknowns + 6 * i);
    next.boards[i].rotation = turned(by.segment<3>(first), boards[i].rotation);
    next.boards[i].translation += by.segment<3>(first + 3);
  }
  return next;
}

CameraState CameraState::moved(int unknown, double by) const {
  VectorXd all = VectorXd::Zero(unknowns());
  all[unknown] = by;
  return moved(all);
}

double CameraState::step(int unknown) { return unknown <= kCy ? 1e-2 : 1e-5; }

MatrixXd jacobianOf(const ResidualBlock& block, const CameraState& state) {
  MatrixXd slopes;
  for (std::size_t i = 0; i < block.unknowns.size(); ++i) {
    const double step = CameraState::step(block.unknowns[i]);
    const VectorXd slope = (block.residuals(state.moved(block.unknowns[i], step)) -
                            block.residuals(state.moved(block.unknowns[i], -step))) /
                           (2 * step);
    if (i == 0) slopes.resize(slope.size(), static_cast<Eigen::Index>(block.unknowns.size()));
    slopes.col(static_cast<Eigen::Index>(i)) = slope;
  }
  return slopes;
}

CameraSolution solveCamera(const std::vector<ResidualBlock>& blocks, const CameraState& start) {
  CameraSolution solution;
  solution.state = start;
  solution.cost = costOf(blocks, start);
  double damping = 1e-3;
  Equations equations = equationsAt(blocks, start);
  for (int i = 0; i < kIterations; ++i) {
    MatrixXd damped = equations.information;
    damped.diagonal() *= 1 + damping;
    const VectorXd by = damped.ldlt().solve(equations.gradient);
    const CameraState tried = solution.state.moved(by);
    const double cost = by.allFinite() ? costOf(blocks, tried) : HUGE_VAL;
    if (!(cost < solution.cost)) {
      damping *= 10;
      if (damping > 1e9) break;
      continue;
    }
    const bool converged = solution.cost - cost <= kConverged * solution.cost;
    solution.state = tried;
    solution.cost = cost;
    damping = std::max(damping / 10, 1e-9);
    equations = equationsAt(blocks, tried);
    if (converged) break;
  }
  // In units of each unknown's own information: singular means that two cannot be told apart.
  const VectorXd scale = equations.information.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * equations.information * scale.cwiseInverse().asDiagonal();
  if (!scaled.allFinite()) return solution;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
  solution.determined = solver.eigenvalues()[0] > kSingular;
  if (solution.determined) {
    solution.covariance = scale.cwiseInverse().asDiagonal() *
                          scaled.ldlt().solve(MatrixXd::Identity(scaled.rows(), scaled.cols())) *
                          scale.cwiseInverse().asDiagonal();
  }
  return solution;
}

}  // namespace lab::calibration
