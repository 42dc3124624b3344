/// From expected grey values to a camera's bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// Normal noise from a table, read from another random place for every piece of every row.
class Grain {
 public:
  explicit Grain(std::uint64_t seed);

  /// @param mean [DN] expected values, rows of `width`
  void finish(std::span<const float> mean, int width, const PixelNoise& noise, double black,
              std::int64_t frame, std::span<std::uint8_t> out) const;

 private:
  std::uint64_t seed_;
  std::vector<float> table_;
};

}  // namespace lab::sim::painter
