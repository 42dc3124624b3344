/// Compares cameras by the robots that they see together: offsets of their clocks, and how their
/// calibrations differ.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace lab::tracker {

/// The time stamps of a camera are later than those of the first camera by `offset`.
struct ClockOffset {
  double offset = 0;                                       ///< [s]
  double sigma = std::numeric_limits<double>::infinity();  ///< [s] standard error; not known: inf
};

/// How the places that a camera gives are wrong: a shift, a small rotation and a strain about the
/// centre of its view.
struct ViewError {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();    ///< [m]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();     ///< [m]
  Eigen::Matrix2d gradient = Eigen::Matrix2d::Zero();  ///< [1] of the error over the place

  /// [m] the error at a place
  [[nodiscard]] Eigen::Vector2d at(double x, double y) const {
    return shift + gradient * (Eigen::Vector2d(x, y) - centre);
  }
  /// [rad] the error of headings
  [[nodiscard]] double rotation() const { return 0.5 * (gradient(1, 0) - gradient(0, 1)); }
};

/// A robot with velocity v that two cameras a and b stamp at the same time appears displaced by
/// e_b - e_a - v (offset_b - offset_a), where e is the error of a calibration at this place.
///
/// Overlaps are divided into cells, in each of which e_b - e_a is constant: that of a shift,
/// rotation and strain with the normal prior of calibrations by `lab calibrate camera`, and a
/// deviation with the standard deviation kCellError. The velocities in the cells give the
/// difference of the offsets, and least squares over all pairs the offsets from the first camera.
/// Robots that drive in one direction with one speed cannot tell an offset from a displacement; the
/// standard error is then infinite or large. It follows from the given covariances, multiplied by
/// the root of the reduced chi-square within cells if that is above 1.
///
/// The displacements of the cells then give the errors of the calibrations. What overlaps cannot
/// tell, as a shift of all cameras together, remains 0.
class ViewComparison {
 public:
  explicit ViewComparison(std::size_t cameras) : cameras_(cameras), centres_(cameras) {}

  /// Adds a robot that cameras a and b see.
  /// @param place [m]
  /// @param displacement [m] its place by b minus that by a, both moved to one time stamp
  /// @param velocity [m/s]
  /// @param covariance [m^2] of the displacement
  void add(std::size_t a, std::size_t b, const Eigen::Vector2d& place,
           const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
           const Eigen::Matrix2d& covariance);

  /// Adds a place at which a camera sees a robot: the mean is the centre of its view.
  void addToView(std::size_t camera, const Eigen::Vector2d& place);

  /// By camera; the first one is {0, 0}.
  [[nodiscard]] std::vector<ClockOffset> clocks() const;

  /// By camera.
  /// @param clocks of these cameras; pairs of which an offset is less well known than
  /// `largest_sigma` [s] are left out
  [[nodiscard]] std::vector<ViewError> errors(const std::vector<ClockOffset>& clocks,
                                              double largest_sigma) const;

  static constexpr double kCell = 0.08;           ///< [m]
  static constexpr double kCellError = 1e-4;      ///< [m]
  static constexpr double kShiftError = 1e-3;     ///< [m] standard deviation of a calibration
  static constexpr double kRotationError = 2e-3;  ///< [rad]
  static constexpr double kStrainError = 5e-4;    ///< [1]

 private:
  /// Normal equations of (offset, displacement x, y).
  struct Cell {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    double squares = 0;
    std::int64_t count = 0;
    Eigen::Vector2d places = Eigen::Vector2d::Zero();  ///< [m] sum
  };
  using Key = std::array<int, 2>;
  using Cells = std::map<Key, Cell>;
  struct View {
    Eigen::Vector2d places = Eigen::Vector2d::Zero();  ///< [m] sum
    std::int64_t count = 0;
  };

  [[nodiscard]] static ClockOffset offsetOf(const Cells& cells);
  [[nodiscard]] static double reducedSquares(const Cells& cells, double offset);

  std::size_t cameras_;
  std::vector<View> centres_;
  std::map<std::pair<std::size_t, std::size_t>, Cells> pairs_;  ///< by cameras, the lower one first
};

}  // namespace lab::tracker
