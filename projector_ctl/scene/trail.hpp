/// What robots leave behind: a field that is laid down under them, decays and spreads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "light/field/image.hpp"

namespace lab::projector {

/// dm/dt = sources - decay m + diffusion laplacian m, on square cells over the arena, with walls
/// that nothing passes.
///
/// A robot's source is rate K(r) with K(r) = (1 - (r / radius)^2)^2 up to the radius, drawn along
/// its path; its weights over the cells are scaled to hold rate pi radius^2 / 3 exactly, all of it
/// inside the walls. Decay is exact. Diffusion is explicit, in sub-steps with diffusion dt / h^2 at
/// most 1/5, which keep m positive and lose nothing.
///
/// Time is that of camera frames: the state is a function of the frames laid, in their order, and
/// a picture one of the state and the moment it is for.
class Trail {
 public:
  struct Settings {
    double width = 0;   ///< [m] of the arena
    double height = 0;  ///< [m]
    std::size_t most_cells = 160 * 120;
    double radius = 0;     ///< [m]
    double rate = 1;       ///< [1/s] of m, in the middle of a robot that stands
    double decay = 0;      ///< [1/s]
    double diffusion = 0;  ///< [m^2/s]
  };

  /// The picture of a trail nobody adds to spreads in strides of this; it decays all the time.
  static constexpr std::int64_t kStride_us = 250'000;

  explicit Trail(const Settings& settings);

  /// Lets time pass up to `utime`, as it did since the last call; earlier is not gone back to.
  void advanceTo(std::int64_t utime);

  /// A robot went straight from one place to the other between these times, the later one not
  /// after advanceTo()'s: adds what is left of what it laid.
  void lay(double from_x, double from_y, std::int64_t from_utime, double to_x, double to_y,
           std::int64_t to_utime);

  /// m as bytes at `utime`, 0..1 as 0..255 and nothing above: the same pointer while the bytes are
  /// the same.
  std::shared_ptr<const light::Image> picture(std::int64_t utime);

  /// Integral of m over the arena [m^2], at the time of advanceTo().
  [[nodiscard]] double mass() const;

  /// What one robot adds to the mass [m^2/s].
  [[nodiscard]] double source() const;

  /// m of a cell, at the time of advanceTo(); column and row from the origin's corner.
  [[nodiscard]] double at(int column, int row) const {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }

  [[nodiscard]] double cell() const { return cell_; }  ///< [m] side
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

 private:
  using Cells = std::vector<double>;

  void pass(Cells& cells, double time);
  void spread(Cells& cells, double share);
  void add(double x, double y, double amount);

  Settings settings_;
  double cell_;
  int columns_;
  int rows_;
  bool empty_ = true;  ///< nothing was laid yet
  std::int64_t utime_ = 0;
  Cells cells_;  ///< the bottom row first
  Cells buffer_;
  std::vector<double> weights_;
  Cells carried_;             ///< cells_, `strides_` strides later
  std::int64_t strides_ = 0;  ///< 0: carried_ is not read
  std::shared_ptr<const light::Image> picture_;
};

}  // namespace lab::projector
