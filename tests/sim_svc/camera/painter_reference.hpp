// An independent, slow implementation of the simulated camera: many rays per pixel through the
// exact lens model, weighted by the Gaussian blur. It shares no code with the painter.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::reference {

/// A window of whole pixels.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

/// @param grey returns the value that a ray through this point of the picture meets [DN]
/// @param rays number of rays along a pixel's side
inline std::vector<double> blurred(const Window& window, double blur, int rays,
                                   const std::function<double(optics::Pixel)>& grey) {
  const int reach = static_cast<int>(std::ceil(4.5 * blur)) + 1;
  const int columns = (window.width + 2 * reach) * rays;
  const int rows = (window.height + 2 * reach) * rays;
  const auto place = [&](int first, int i) { return first - reach - 0.5 + (i + 0.5) / rays; };
  // Weight of a ray by its distance from the pixel's centre: the Gaussian convolved with the
  // pixel's square.
  const auto weight = [&](double d) {
    const double s = blur * std::sqrt(2.0);
    return 0.5 * (std::erf((d + 0.5) / s) - std::erf((d - 0.5) / s)) / rays;
  };
  std::vector<double> across(static_cast<std::size_t>(rows * window.width));
  std::vector<double> row(static_cast<std::size_t>(columns));
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      row[static_cast<std::size_t>(i)] = grey({place(window.x, i), place(window.y, j)});
    }
    for (int u = 0; u < window.width; ++u) {
      double sum = 0;
      for (int i = u * rays; i < (u + 1 + 2 * reach) * rays; ++i) {
        sum += row[static_cast<std::size_t>(i)] * weight(place(window.x, i) - window.x - u);
      }
      across[static_cast<std::size_t>(j * window.width + u)] = sum;
    }
  }
  std::vector<double> out(static_cast<std::size_t>(window.width * window.height));
  for (int v = 0; v < window.height; ++v) {
    for (int j = v * rays; j < (v + 1 + 2 * reach) * rays; ++j) {
      const double w = weight(place(window.y, j) - window.y - v);
      for (int u = 0; u < window.width; ++u) {
        out[static_cast<std::size_t>(v * window.width + u)] +=
            w * across[static_cast<std::size_t>(j * window.width + u)];
      }
    }
  }
  return out;
}

/// The albedo of a cap at a point of the cap plane.
inline double capAlbedo(const PainterSettings& settings, const PaintedRobot& robot,
                        optics::Place at) {
  const double dx = at.x - robot.x;
  const double dy = at.y - robot.y;
  const double forward = dx * std::cos(robot.theta) + dy * std::sin(robot.theta);
  const double left = dy * std::cos(robot.theta) - dx * std::sin(robot.theta);
  const auto within = [&](double centre, double radius) {
    return std::hypot(forward - centre, left) < radius;
  };
  const optics::CapGeometry& cap = settings.cap;
  if (within(cap.big_offset, cap.big_radius) || within(cap.small_offset, cap.small_radius)) {
    return settings.albedos.circle;
  }
  return within(0.0325, 0.002) || within(-0.0325, 0.002) ? settings.albedos.hole
                                                         : settings.albedos.cap;
}

/// The pixels of the window, from a whole picture.
inline std::vector<double> cut(const std::vector<float>& picture, int width, const Window& window) {
  std::vector<double> out;
  for (int y = window.y; y < window.y + window.height; ++y) {
    for (int x = window.x; x < window.x + window.width; ++x) {
      out.push_back(static_cast<double>(picture[static_cast<std::size_t>(y * width + x)]));
    }
  }
  return out;
}

/// Centroid of the darkness (full - grey) in a window.
inline optics::Pixel middle(const std::vector<double>& grey, const Window& window, double full) {
  double sum = 0;
  optics::Pixel at;
  for (int v = 0; v < window.height; ++v) {
    for (int u = 0; u < window.width; ++u) {
      const double dark = full - grey[static_cast<std::size_t>(v * window.width + u)];
      sum += dark;
      at.x += dark * (window.x + u);
      at.y += dark * (window.y + v);
    }
  }
  return {at.x / sum, at.y / sum};
}

}  // namespace lab::sim::reference
