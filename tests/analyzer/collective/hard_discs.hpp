/// Hard discs in a periodic box by Metropolis Monte Carlo, for tests: independent of the analyzer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace lab::collective {

class HardDiscs {
 public:
  /// Discs of diameter 1 on a triangular lattice of columns x rows (rows even), at a packing
  /// fraction.
  HardDiscs(int columns, int rows, double packing, std::uint64_t seed) : random_(seed) {
    const double spacing =
        std::sqrt(std::numbers::pi / (2 * std::numbers::sqrt3 * packing));  // lattice constant
    width_ = spacing * columns;
    height_ = spacing * 0.5 * std::numbers::sqrt3 * rows;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        places_.emplace_back(spacing * (column + (row % 2 == 0 ? 0.25 : 0.75)),
                             spacing * 0.5 * std::numbers::sqrt3 * (row + 0.5));
      }
    }
    step_ = std::max(0.05, spacing - 1);
    across_ = static_cast<int>(width_);
    along_ = static_cast<int>(height_);
    cells_.resize(static_cast<std::size_t>(across_ * along_));
    for (std::size_t i = 0; i < places_.size(); ++i) cells_[cellOf(places_[i])].push_back(i);
  }

  /// One trial move per disc.
  void sweep() {
    std::uniform_real_distribution<double> move(-step_, step_);
    std::uniform_int_distribution<std::size_t> which(0, places_.size() - 1);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const std::size_t i = which(random_);
      std::pair<double, double> to = places_[i];
      to.first = wrapped(to.first + move(random_), width_);
      to.second = wrapped(to.second + move(random_), height_);
      if (overlaps(to, i)) continue;
      const std::size_t from_cell = cellOf(places_[i]);
      const std::size_t to_cell = cellOf(to);
      places_[i] = to;
      if (from_cell == to_cell) continue;
      std::erase(cells_[from_cell], i);
      cells_[to_cell].push_back(i);
    }
  }

  [[nodiscard]] const std::vector<std::pair<double, double>>& places() const { return places_; }
  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }

 private:
  static double wrapped(double x, double length) {
    x = std::fmod(x, length);
    return x < 0 ? x + length : x;
  }

  [[nodiscard]] std::size_t cellOf(const std::pair<double, double>& place) const {
    const int column = std::min(across_ - 1, static_cast<int>(place.first / width_ * across_));
    const int row = std::min(along_ - 1, static_cast<int>(place.second / height_ * along_));
    return static_cast<std::size_t>(row * across_ + column);
  }

  [[nodiscard]] bool overlaps(const std::pair<double, double>& place, std::size_t self) const {
    const auto cell = static_cast<int>(cellOf(place));
    const int column = cell % across_;
    const int row = cell / across_;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const int c = (column + dc + across_) % across_;
        const int r = (row + dr + along_) % along_;
        for (const std::size_t other : cells_[static_cast<std::size_t>(r * across_ + c)]) {
          if (other == self) continue;
          const double dx = std::remainder(place.first - places_[other].first, width_);
          const double dy = std::remainder(place.second - places_[other].second, height_);
          if (dx * dx + dy * dy < 1) return true;
        }
      }
    }
    return false;
  }

  std::mt19937_64 random_;
  double width_;
  double height_;
  double step_;
  int across_;
  int along_;
  std::vector<std::pair<double, double>> places_;
  std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace lab::collective
