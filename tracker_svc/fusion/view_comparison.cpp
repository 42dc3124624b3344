#include "tracker_svc/fusion/view_comparison.hpp"

#include <algorithm>
#include <cmath>

namespace lab::tracker {
namespace {

constexpr std::int64_t kFewest = 10;  // robots, before a pair of cameras is used
constexpr double kUnknown = 0.5;      // [s] standard error of an offset that says nothing
constexpr int kTerms = 6;             // of the error of a view

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

/// The error at a place per unit of shift x, y, rotation, scale, and both strains.
Eigen::Matrix<double, 2, kTerms> termsAt(const Eigen::Vector2d& from_centre) {
  const double x = from_centre.x();
  const double y = from_centre.y();
  Eigen::Matrix<double, 2, kTerms> terms;
  terms << 1, 0, -y, x, x, y,  //
      0, 1, x, y, -y, x;
  return terms;
}

/// [m^-2], [rad^-2] or [1] of the prior of a term.
double priorInformation(int term) {
  constexpr std::array<double, kTerms> kPrior{
      ViewComparison::kShiftError,  ViewComparison::kShiftError,  ViewComparison::kRotationError,
      ViewComparison::kStrainError, ViewComparison::kStrainError, ViewComparison::kStrainError};
  return std::pow(kPrior[static_cast<std::size_t>(term)], -2);
}

}  // namespace

void ViewComparison::add(std::size_t a, std::size_t b, const Eigen::Vector2d& place,
                         const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                         const Eigen::Matrix2d& covariance) {
  const double sign = a < b ? 1 : -1;
  const Key key{static_cast<int>(std::floor(place.x() / kCell)),
                static_cast<int>(std::floor(place.y() / kCell))};
  Cell& cell = pairs_[{std::min(a, b), std::max(a, b)}][key];
  Eigen::Matrix<double, 2, 3> model;
  model << -velocity.x(), 1, 0, -velocity.y(), 0, 1;
  const Eigen::Matrix2d weight = covariance.inverse();
  const Eigen::Vector2d measured = sign * displacement;
  cell.information += model.transpose() * weight * model;
  cell.weighted += model.transpose() * weight * measured;
  cell.squares += measured.dot(weight * measured);
  ++cell.count;
  cell.places += place;
}

void ViewComparison::addToView(std::size_t camera, const Eigen::Vector2d& place) {
  centres_[camera].places += place;
  ++centres_[camera].count;
}

/// The difference of the offsets of two cameras. The displacement of each cell is that of a shift,
/// rotation and strain, with the prior of two calibrations, and a deviation from it, which is
/// eliminated.
ClockOffset ViewComparison::offsetOf(const Cells& cells) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::int64_t count = 0;
  for (const auto& [key, cell] : cells) {
    centre += cell.places;
    count += cell.count;
  }
  if (count < kFewest) return {};
  centre /= static_cast<double>(count);
  Eigen::Matrix<double, 1 + kTerms, 1 + kTerms> information;
  information.setZero();
  Eigen::Matrix<double, 1 + kTerms, 1> weighted;
  weighted.setZero();
  for (int i = 0; i < kTerms; ++i) information(i + 1, i + 1) = priorInformation(i) / 2;
  const Eigen::Matrix2d deviation = Eigen::Matrix2d::Identity() / (kCellError * kCellError);
  for (const auto& [key, cell] : cells) {
    const Eigen::Matrix2d inverse =
        (cell.information.bottomRightCorner<2, 2>() + deviation).inverse();
    const Eigen::RowVector2d coupling = cell.information.topRightCorner<1, 2>();
    const Eigen::Vector2d displaced = cell.weighted.tail<2>();
    const auto terms = termsAt(cell.places / static_cast<double>(cell.count) - centre);
    information(0, 0) += cell.information(0, 0) - (coupling * inverse * coupling.transpose())(0);
    information.topRightCorner<1, kTerms>() += coupling * inverse * deviation * terms;
    information.bottomRightCorner<kTerms, kTerms>() +=
        terms.transpose() * (deviation - deviation * inverse * deviation) * terms;
    weighted(0) += cell.weighted(0) - (coupling * inverse * displaced)(0);
    weighted.tail<kTerms>() += terms.transpose() * deviation * inverse * displaced;
  }
  if (!(information(0, 0) > 0)) return {};
  information.bottomLeftCorner<kTerms, 1>() =
      information.topRightCorner<1, kTerms>().transpose().eval();
  const auto covariance = information.inverse().eval();
  const double offset = (covariance * weighted)(0);
  const double variance = covariance(0, 0) * std::max(1.0, reducedSquares(cells, offset));
  return variance > 0 ? ClockOffset{offset, std::sqrt(variance)} : ClockOffset{};
}

/// The reduced chi-square of the places within cells.
double ViewComparison::reducedSquares(const Cells& cells, double offset) {
  double squares = 0;
  double freedom = 0;
  for (const auto& [key, cell] : cells) {
    if (cell.count < 2) continue;
    const Eigen::Vector2d displaced =
        cell.weighted.tail<2>() - offset * cell.information.bottomLeftCorner<2, 1>();
    squares += cell.squares - 2 * offset * cell.weighted(0) +
               offset * offset * cell.information(0, 0) -
               displaced.dot(cell.information.bottomRightCorner<2, 2>().inverse() * displaced);
    freedom += 2 * static_cast<double>(cell.count - 1);
  }
  return freedom > 0 ? squares / freedom : 1;
}

std::vector<ClockOffset> ViewComparison::clocks() const {
  std::map<std::pair<std::size_t, std::size_t>, ClockOffset> known;
  for (const auto& [cameras, cells] : pairs_) {
    const ClockOffset offset = offsetOf(cells);
    if (offset.sigma < kUnknown) known[cameras] = offset;
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

std::vector<ViewError> ViewComparison::errors(const std::vector<ClockOffset>& clocks,
                                              double largest_sigma) const {
  std::vector<ViewError> errors(cameras_);
  for (std::size_t i = 0; i < cameras_; ++i) {
    const View& view = centres_[i];
    if (view.count > 0) errors[i].centre = view.places / static_cast<double>(view.count);
  }
  const auto size = static_cast<Eigen::Index>(cameras_) * kTerms;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    information(i, i) = priorInformation(static_cast<int>(i % kTerms));
  }
  for (const auto& [pair, cells] : pairs_) {
    const double sigma = std::hypot(clocks[pair.first].sigma, clocks[pair.second].sigma);
    if (!(sigma < largest_sigma)) continue;
    const double offset = clocks[pair.second].offset - clocks[pair.first].offset;
    for (const auto& [key, cell] : cells) {
      const Eigen::Matrix2d inverse = cell.information.bottomRightCorner<2, 2>().inverse();
      const Eigen::Vector2d displaced =
          inverse * (cell.weighted.tail<2>() - offset * cell.information.bottomLeftCorner<2, 1>());
      const Eigen::Matrix2d weight =
          (inverse + kCellError * kCellError * Eigen::Matrix2d::Identity()).inverse();
      const Eigen::Vector2d place = cell.places / static_cast<double>(cell.count);
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, size);
      rows.middleCols(static_cast<Eigen::Index>(pair.first) * kTerms, kTerms) =
          -termsAt(place - errors[pair.first].centre);
      rows.middleCols(static_cast<Eigen::Index>(pair.second) * kTerms, kTerms) =
          termsAt(place - errors[pair.second].centre);
      information += rows.transpose() * weight * rows;
      weighted += rows.transpose() * weight * displaced;
    }
  }
  const Eigen::VectorXd solution = information.llt().solve(weighted);
  for (std::size_t i = 0; i < cameras_; ++i) {
    const auto of = solution.segment<kTerms>(static_cast<Eigen::Index>(i) * kTerms);
    errors[i].shift = of.head<2>();
    errors[i].gradient << of(3) + of(4), of(5) - of(2), of(5) + of(2), of(3) - of(4);
  }
  return errors;
}

}  // namespace lab::tracker
