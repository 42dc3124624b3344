/// Converts expected light into a camera's bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "light/photometry/camera_response.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// Normal noise from a table, read from a random position for every piece of every row.
class SensorNoise {
 public:
  /// @param response maps light to bytes
  SensorNoise(std::uint64_t seed, const optics::CameraResponse& response);

  /// Adds noise and applies the camera's response.
  /// @param mean [DN] expected values, linear in light, rows of `width`
  void finish(std::span<const float> mean, int width, const PixelNoise& noise, double black,
              std::int64_t frame, std::span<std::uint8_t> out) const;

 private:
  std::uint64_t seed_;
  std::vector<float> table_;
  std::vector<std::uint8_t> steps_;  // byte for a light in units of 1 / kFine DN; empty: linear
};

}  // namespace lab::sim::painter
