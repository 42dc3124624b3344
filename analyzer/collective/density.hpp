/// Distribution of the local density, its modes, and number fluctuations.
#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/collective/observable.hpp"
#include "analyzer/collective/observation.hpp"

namespace lab::collective {

/// The modes of a histogram that was smoothed twice with the weights 1/4, 1/2, 1/4.
struct Modes {
  int count = 0;                ///< of maxima whose valleys are deeper than the scatter of bins
  double dilute = units::kNan;  ///< position of the lower of the two highest maxima
  double dense = units::kNan;   ///< of the other one
  double valley = units::kNan;  ///< position of the minimum between them
  double depth = 0;         ///< 1 - density in the valley / that of the lower maximum; 0: one mode
  double depth_sigmas = 0;  ///< the difference of these two in standard errors
};

/// @param curve bins of equal width with standard errors
[[nodiscard]] Modes modesOf(const ObservableCurve& curve);

/// Local packing fractions: of Voronoi cells, one value per robot, and of coarse boxes, the share
/// of each box that robots cover.
class DensityDistribution {
 public:
  explicit DensityDistribution(const CrowdSettings& settings);

  /// @param densities of the robots' Voronoi cells
  void add(const std::vector<CrowdRobot>& robots, const std::vector<double>& densities);

  [[nodiscard]] ObservableCurve ofCells() const;  ///< probability density
  [[nodiscard]] ObservableCurve ofBoxes() const;  ///< probability density

  /// Sarle's coefficient (skewness^2 + 1) / kurtosis of the cells' densities: 5/9 of a uniform
  /// distribution, 1/3 of a normal one, 1 of two peaks of no width.
  [[nodiscard]] Average bimodality() const;

 private:
  static constexpr std::size_t kBins = 40;
  static constexpr std::size_t kBlocks = 64;

  CrowdSettings settings_;
  std::size_t columns_;
  std::size_t rows_;
  BlockedSums sums_;
  std::vector<double> covered_;
};

/// The variance of the number of robots in boxes of several sizes. Each size tiles the arena.
/// The mean over the boxes of a frame is exactly N / boxes, so var = mean of (n - N / boxes)^2,
/// divided by 1 - 1 / boxes, because N is given: robots without correlation have var = mean.
class NumberFluctuations {
 public:
  explicit NumberFluctuations(const CrowdSettings& settings);

  void add(const std::vector<CrowdRobot>& robots);

  /// Variance against the mean number; x is that of all frames.
  [[nodiscard]] ObservableCurve variance() const;

  /// The exponent a of dN = N^a, dN the standard deviation, by least squares of the logarithms over
  /// all sizes with a mean number above 1: 1/2 without correlation, up to 1 for giant fluctuations
  /// (Narayan, Ramaswamy and Menon, Science 317, 105, 2007).
  [[nodiscard]] Average exponent() const;

 private:
  struct Grid {
    std::size_t columns;
    std::size_t rows;
  };
  static constexpr std::size_t kPerSize = 2;  // variance, mean number
  static constexpr std::size_t kBlocks = 64;

  Rectangle arena_;
  std::vector<Grid> grids_;
  BlockedSums sums_;
  std::vector<double> counts_;
};

}  // namespace lab::collective
