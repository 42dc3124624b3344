/// Maps of density and current over the arena.
#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/collective/observable.hpp"
#include "analyzer/collective/observation.hpp"

namespace lab::collective {

struct MapCell {
  double x = 0;       ///< [m] centre
  double y = 0;       ///< [m]
  Average density;    ///< robots per area [1/m^2]
  Average current_x;  ///< density times mean velocity [1/(m s)]
  Average current_y;
};

struct CrowdMap {
  std::size_t columns = 0;
  std::size_t rows = 0;
  double cell_width = 0;       ///< [m]
  double cell_height = 0;      ///< [m]
  std::vector<MapCell> cells;  ///< row by row, from the bottom
};

/// Time averages in cells with a side of about two thirds of a diameter; at most 40 along a side of
/// the arena.
class DensityMap {
 public:
  explicit DensityMap(const CrowdSettings& settings);

  void add(const std::vector<CrowdRobot>& robots);

  [[nodiscard]] CrowdMap map() const;

 private:
  static constexpr std::size_t kPerCell = 3;  // robots, sums of their velocities
  static constexpr std::size_t kBlocks = 32;

  Rectangle arena_;
  std::size_t columns_;
  std::size_t rows_;
  BlockedSums sums_;
};

}  // namespace lab::collective
