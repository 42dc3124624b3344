/// Trails of robots: a field with sources at the robots, decay and diffusion.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "light/field/image.hpp"

namespace lab::projector {

/// Solves dm/dt = sources - decay m + diffusion laplacian m on square cells over the arena, with
/// no-flux boundaries at the walls.
///
/// A robot's source is rate K(r) with K(r) = (1 - (r / radius)^2)^2 for r < radius, moved along its
/// path. Its weights over the cells inside the walls are scaled such that their integral is exactly
/// rate pi radius^2 / 3. Decay is exact. Diffusion is an explicit scheme with sub-steps such that
/// diffusion dt / h^2 <= 1/5, which keeps m positive and conserves mass. Many sub-steps are taken
/// at once, by the modes of the scheme, so a long time costs no more than a short one. The cells
/// then differ from those of single sub-steps by less than 1e-12 of the largest one.
///
/// All times are those of the camera frames. The state depends only on the frames and their order.
/// A picture depends only on the state and on the time for which it is requested.
class Trail {
 public:
  struct Settings {
    double width = 0;   ///< [m] of the arena
    double height = 0;  ///< [m]
    std::size_t most_cells = 160 * 120;
    double radius = 0;     ///< [m]
    double rate = 1;       ///< [1/s] growth of m at the centre of a standing robot
    double decay = 0;      ///< [1/s]
    double diffusion = 0;  ///< [m^2/s]
  };

  /// Without new frames, the diffusion in the picture advances in steps of this length; decay is
  /// continuous.
  static constexpr std::int64_t kStride_us = 250'000;

  explicit Trail(const Settings& settings);

  /// Advances the state to `utime`; earlier times are ignored.
  void advanceTo(std::int64_t utime);

  /// Adds what a robot has deposited that moved on a straight line between two points and times,
  /// less the decay since then. to_utime must not be after the time of advanceTo().
  void lay(double from_x, double from_y, std::int64_t from_utime, double to_x, double to_y,
           std::int64_t to_utime);

  /// m at `utime` as bytes: 0..1 is mapped to 0..255 and clamped. Returns the same pointer while
  /// the bytes do not change.
  std::shared_ptr<const light::Image> picture(std::int64_t utime);

  /// Integral of m over the arena [m^2], at the time of advanceTo().
  [[nodiscard]] double mass() const;

  /// The mass that one robot adds per second [m^2/s].
  [[nodiscard]] double source() const;

  /// m in a cell at the time of advanceTo(); columns and rows count from the origin.
  [[nodiscard]] double at(int column, int row) const {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }

  [[nodiscard]] double cell() const { return cell_; }  ///< [m] side
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

 private:
  using Cells = std::vector<double>;

  void pass(Cells& cells, double time, std::int64_t times);
  void spread(Cells& cells, double share);
  void spreadAtOnce(Cells& cells, double share, double steps) const;
  void add(double x, double y, double amount);

  Settings settings_;
  double cell_;
  int columns_;
  int rows_;
  bool empty_ = true;  ///< no source was added yet
  std::int64_t utime_ = 0;
  Cells cells_;  ///< bottom row first
  Cells buffer_;
  std::vector<double> weights_;
  Cells carried_;             ///< cells_, advanced by `strides_` steps of kStride_us
  std::int64_t strides_ = 0;  ///< 0: carried_ is not valid
  std::shared_ptr<const light::Image> picture_;
};

}  // namespace lab::projector
