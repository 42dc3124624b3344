#include "light/optics/bundle_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "light/optics/levenberg_marquardt.hpp"

namespace lab::calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kEvaluations = 100;
constexpr double kConverged = 1e-10;  // relative reduction of the cost
constexpr double kHuber = 2;          // [standard deviations] above which the cost grows linearly
constexpr double kSingular = 1e-14;

Matrix3d turned(const Vector3d& by, const Matrix3d& rotation) {
  const double angle = by.norm();
  if (angle <= 0) return rotation;
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() * rotation;
}

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

// The square of this is the Huber cost, so that a least-squares solver minimises the Huber cost.
double rootOfHuberCost(double residual) {
  return std::copysign(std::sqrt(huberCost(residual)), residual);
}

double slopeOfHuberRoot(double residual) {
  return std::abs(residual) <= kHuber ? 1 : kHuber / std::sqrt(huberCost(residual));
}

/// Row of each block's first residual in the stack of all residuals; the last element is their
/// number.
std::vector<int> firstRows(const std::vector<ResidualBlock>& blocks, const CameraState& state) {
  std::vector<int> first = {0};
  for (const ResidualBlock& block : blocks) {
    first.push_back(first.back() + static_cast<int>(block.residuals(state).size()));
  }
  return first;
}

/// J^T W J with the Huber weights W.
MatrixXd informationAt(const std::vector<ResidualBlock>& blocks, const CameraState& state) {
  MatrixXd sum = MatrixXd::Zero(state.unknowns(), state.unknowns());
  for (const ResidualBlock& block : blocks) {
    const MatrixXd slopes = jacobianOf(block, state);
    VectorXd weights = VectorXd::Ones(slopes.rows());
    if (block.robust) {
      weights = kHuber / block.residuals(state).cwiseAbs().cwiseMax(kHuber).array();
    }
    const MatrixXd information = slopes.transpose() * weights.asDiagonal() * slopes;
    for (std::size_t i = 0; i < block.unknowns.size(); ++i) {
      for (std::size_t j = 0; j < block.unknowns.size(); ++j) {
        sum(block.unknowns[i], block.unknowns[j]) +=
            information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }
  return sum;
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
  const std::vector<int> first = firstRows(blocks, start);
  optics::LeastSquaresProblem problem;
  problem.residuals = first.back();
  problem.tolerance = kConverged;
  problem.evaluations = kEvaluations;
  problem.residuals_at = [&](const VectorXd& x, Eigen::Ref<VectorXd> out) {
    const CameraState state = start.moved(x);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      VectorXd residuals = blocks[i].residuals(state);
      if (blocks[i].robust) residuals = residuals.unaryExpr(&rootOfHuberCost).eval();
      out.segment(first[i], residuals.size()) = residuals;
    }
  };
  problem.jacobian_at = [&](const VectorXd& x, Eigen::Ref<MatrixXd> out) {
    const CameraState state = start.moved(x);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const ResidualBlock& block = blocks[i];
      VectorXd slopes = VectorXd::Ones(first[i + 1] - first[i]);
      if (block.robust) slopes = block.residuals(state).unaryExpr(&slopeOfHuberRoot);
      for (const int unknown : block.unknowns) {
        const double step = CameraState::step(unknown);
        VectorXd forward = x;
        VectorXd backward = x;
        forward[unknown] += step;
        backward[unknown] -= step;
        out.col(unknown).segment(first[i], slopes.size()) = slopes.cwiseProduct(
            (block.residuals(start.moved(forward)) - block.residuals(start.moved(backward))) /
            (2 * step));
      }
    }
  };
  CameraSolution solution;
  solution.state =
      start.moved(optics::solveLeastSquares(problem, VectorXd::Zero(start.unknowns())));
  solution.cost = costOf(blocks, solution.state);
  if (auto covariance = optics::covarianceOf(informationAt(blocks, solution.state), kSingular)) {
    solution.covariance = std::move(*covariance);
    solution.determined = true;
  }
  return solution;
}

}  // namespace lab::calibration
