#include "tracker_svc/fusion/clock_offsets.hpp"

#include <algorithm>
#include <cmath>

namespace lab::tracker {
namespace {

constexpr std::int64_t kFewest = 10;  // robots, before a pair of cameras is used

/// Cameras that are connected with the first one by pairs, in ascending order, without the first.
std::vector<std::size_t> connected(
    const std::map<std::pair<std::size_t, std::size_t>, ClockOffset>& pairs, std::size_t cameras) {
  std::vector<bool> reached(cameras, false);
  reached[0] = true;
  for (std::size_t pass = 1; pass < cameras; ++pass) {
    for (const auto& [pair, offset] : pairs) {
      const bool any = reached[pair.first] || reached[pair.second];
      reached[pair.first] = reached[pair.first] || any;
      reached[pair.second] = reached[pair.second] || any;
    }
  }
  std::vector<std::size_t> list;
  for (std::size_t i = 1; i < cameras; ++i) {
    if (reached[i]) list.push_back(i);
  }
  return list;
}

}  // namespace

void ClockOffsets::add(std::size_t a, std::size_t b, const Eigen::Vector2d& displacement,
                       const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance) {
  const double sign = a < b ? 1 : -1;
  Pair& pair = pairs_[{std::min(a, b), std::max(a, b)}];
  Eigen::Matrix<double, 2, 3> model;
  model << -velocity.x(), 1, 0, -velocity.y(), 0, 1;
  const Eigen::Matrix2d weight = covariance.inverse();
  const Eigen::Vector2d measured = sign * displacement;
  pair.information += model.transpose() * weight * model;
  pair.weighted += model.transpose() * weight * measured;
  pair.squares += measured.dot(weight * measured);
  ++pair.count;
}

std::vector<ClockOffset> ClockOffsets::solve() const {
  std::map<std::pair<std::size_t, std::size_t>, ClockOffset> known;
  for (const auto& [cameras, pair] : pairs_) {
    if (pair.count < kFewest) continue;
    const Eigen::FullPivLU<Eigen::Matrix3d> equations(pair.information);
    if (!equations.isInvertible()) continue;
    const Eigen::Vector3d solution = equations.solve(pair.weighted);
    const double freedom = 2 * static_cast<double>(pair.count) - 3;
    const double reduced = (pair.squares - solution.dot(pair.weighted)) / freedom;
    const double variance = equations.inverse()(0, 0) * std::max(1.0, reduced);
    if (variance > 0) known[cameras] = {solution(0), std::sqrt(variance)};
  }
  std::vector<ClockOffset> offsets(cameras_);
  if (cameras_ == 0) return offsets;
  offsets[0] = {0, 0};
  const std::vector<std::size_t> list = connected(known, cameras_);
  if (list.empty()) return offsets;
  const auto size = static_cast<Eigen::Index>(list.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(size);
  for (const auto& [pair, offset] : known) {
    const auto first = std::ranges::find(list, pair.first);
    const auto second = std::ranges::find(list, pair.second);
    if (second == list.end()) continue;  // not connected with the first camera
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (first != list.end()) row(first - list.begin()) = -1;
    row(second - list.begin()) = 1;
    const double weight = 1 / (offset.sigma * offset.sigma);
    information += weight * row * row.transpose();
    weighted += weight * offset.offset * row;
  }
  const Eigen::MatrixXd covariance = information.inverse();
  const Eigen::VectorXd solution = covariance * weighted;
  for (Eigen::Index i = 0; i < size; ++i) {
    offsets[list[static_cast<std::size_t>(i)]] = {solution(i), std::sqrt(covariance(i, i))};
  }
  return offsets;
}

}  // namespace lab::tracker
