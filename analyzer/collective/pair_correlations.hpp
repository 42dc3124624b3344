/// Pair distribution g(r) and velocity correlation C_v(r).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analyzer/collective/observable.hpp"
#include "analyzer/collective/observation.hpp"

namespace lab::collective {

/// g(r) = pairs found at the distance r / pairs expected of robots without correlation, both summed
/// over all frames. The expectation for one robot is (N - 1) times the area of the ring around it
/// that lies where centres can be, over the area of all such places. So robots near walls count
/// with the part of their ring that is inside, exactly.
///
/// C_v(r) = sum of v_i . v_j over the pairs at the distance r / (their number times the mean of v^2
/// in their frame).
class PairCorrelations {
 public:
  /// @param bin_width [m]; bins are from 0 to `reach` [m]
  PairCorrelations(const Rectangle& centres, double bin_width, double reach);

  /// Bins of a 15th of the diameter up to six diameters, or half of the arena's shorter side.
  explicit PairCorrelations(const CrowdSettings& settings);

  void add(const std::vector<CrowdRobot>& robots);

  [[nodiscard]] ObservableCurve distribution() const;  ///< bins that are at least partly reachable
  [[nodiscard]] ObservableCurve velocities() const;    ///< bins with pairs

 private:
  // Channels: for each bin pairs found, pairs expected, v_i . v_j, pairs times v^2.
  static constexpr std::size_t kPerBin = 4;
  static constexpr std::size_t kBlocks = 64;

  void expect(const std::vector<CrowdRobot>& robots, std::span<double> sums) const;

  Rectangle centres_;
  double bin_width_;
  std::size_t bins_;
  BlockedSums sums_;
  std::vector<Point> points_;
  std::vector<std::size_t> order_;
};

}  // namespace lab::collective
