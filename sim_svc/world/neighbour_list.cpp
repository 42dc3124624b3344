#include "sim_svc/world/neighbour_list.hpp"

#include <algorithm>
#include <cmath>

namespace lab::sim {
namespace {

// Limits the number of cells for few robots in a large arena, where empty cells cost more than they
// save. It is well above the number of robots, because they may crowd in a part of the arena.
constexpr std::size_t kCellsPerSide = 16;
constexpr std::size_t kMostCellsPerSide = 512;

std::size_t cellsAlong(double size, double cutoff, std::size_t points) {
  const std::size_t most = std::min(kCellsPerSide + points, kMostCellsPerSide);
  return std::clamp(static_cast<std::size_t>(size / cutoff), std::size_t{1}, most);
}

std::size_t cellAlong(double x, double size, std::size_t cells) {
  const double cell = std::clamp(x / size, 0.0, 1.0) * static_cast<double>(cells);
  return std::min(static_cast<std::size_t>(cell), cells - 1);
}

}  // namespace

void NeighbourList::build(std::span<const Vec> points, const Arena& arena, double cutoff) {
  sortIntoCells(points, arena, cutoff);
  first_.assign(1, 0);
  neighbours_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t column = cell_of_[i] % columns_;
    const std::size_t row = cell_of_[i] / columns_;
    const std::size_t left = column == 0 ? 0 : column - 1;
    const std::size_t right = std::min(column + 1, columns_ - 1);
    for (std::size_t r = row == 0 ? 0 : row - 1; r <= std::min(row + 1, rows_ - 1); ++r) {
      // The cells of one row lie one after the other.
      const std::uint32_t end = cell_first_[r * columns_ + right + 1];
      for (std::uint32_t m = cell_first_[r * columns_ + left]; m < end; ++m) {
        const std::uint32_t j = members_[m];
        const double dx = points[j].x - points[i].x;
        const double dy = points[j].y - points[i].y;
        if (dx * dx + dy * dy < cutoff * cutoff && j != i) {
          neighbours_.push_back(j);
        }
      }
    }
    first_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
}

void NeighbourList::sortIntoCells(std::span<const Vec> points, const Arena& arena, double cutoff) {
  columns_ = cellsAlong(arena.width, cutoff, points.size());
  rows_ = cellsAlong(arena.height, cutoff, points.size());
  cell_of_.resize(points.size());
  cell_first_.assign(columns_ * rows_ + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    cell_of_[i] = cellAlong(points[i].y, arena.height, rows_) * columns_ +
                  cellAlong(points[i].x, arena.width, columns_);
    ++cell_first_[cell_of_[i] + 1];
  }
  for (std::size_t cell = 0; cell < columns_ * rows_; ++cell) {
    cell_first_[cell + 1] += cell_first_[cell];
  }
  members_.resize(points.size());
  std::vector<std::uint32_t> next(cell_first_.begin(), cell_first_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    members_[next[cell_of_[i]]++] = static_cast<std::uint32_t>(i);
  }
}

}  // namespace lab::sim
