#include "analyzer/collective/density_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace lab::collective {
namespace {

constexpr double kCellDiameters = 2.0 / 3;
constexpr double kMostCells = 40;  // along a side

std::size_t cellsAlong(double length, double longer, double diameter) {
  const double cell = std::max(kCellDiameters * diameter, longer / kMostCells);
  return static_cast<std::size_t>(std::max(1.0, std::round(length / cell)));
}

std::size_t indexOf(double position, double length, std::size_t count) {
  const double at = std::clamp(position / length, 0.0, 1.0) * static_cast<double>(count);
  return std::min(count - 1, static_cast<std::size_t>(at));
}

void scale(Average& average, double factor) {
  for (double* value : {&average.value, &average.sigma, &average.low, &average.high}) {
    *value *= factor;
  }
}

}  // namespace

DensityMap::DensityMap(const CrowdSettings& settings)
    : arena_(settings.arena),
      columns_(
          cellsAlong(arena_.width(), std::max(arena_.width(), arena_.height()), settings.diameter)),
      rows_(cellsAlong(arena_.height(), std::max(arena_.width(), arena_.height()),
                       settings.diameter)),
      sums_(columns_ * rows_ * kPerCell + 1, kBlocks) {}

void DensityMap::add(const std::vector<CrowdRobot>& robots) {
  const std::span<double> sums = sums_.frame();
  for (const CrowdRobot& robot : robots) {
    const std::size_t column = indexOf(robot.x - arena_.left, arena_.width(), columns_);
    const std::size_t row = indexOf(robot.y - arena_.bottom, arena_.height(), rows_);
    const std::size_t cell = kPerCell * (row * columns_ + column);
    sums[cell] += 1;
    if (!std::isfinite(robot.velocity_x)) continue;
    sums[cell + 1] += robot.velocity_x;
    sums[cell + 2] += robot.velocity_y;
  }
  sums.back() += 1;  // frames
  sums_.endFrame();
}

CrowdMap DensityMap::map() const {
  CrowdMap map{columns_,
               rows_,
               arena_.width() / static_cast<double>(columns_),
               arena_.height() / static_cast<double>(rows_),
               {}};
  const std::size_t frames = sums_.channels() - 1;
  if (!(sums_.total(frames) > 0)) return map;
  const double per_area = 1 / (map.cell_width * map.cell_height);
  for (std::size_t i = 0; i < columns_ * rows_; ++i) {
    MapCell cell;
    cell.x = arena_.left + map.cell_width * (static_cast<double>(i % columns_) + 0.5);
    cell.y = arena_.bottom + map.cell_height * (static_cast<double>(i / columns_) + 0.5);
    cell.density = averageOf(sums_, kPerCell * i, frames);
    cell.current_x = averageOf(sums_, kPerCell * i + 1, frames);
    cell.current_y = averageOf(sums_, kPerCell * i + 2, frames);
    for (Average* average : {&cell.density, &cell.current_x, &cell.current_y}) {
      scale(*average, per_area);
    }
    map.cells.push_back(cell);
  }
  return map;
}

}  // namespace lab::collective
