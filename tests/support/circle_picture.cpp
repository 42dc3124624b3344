#include "tests/support/circle_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lab::detector::testing {
namespace {

constexpr int kFine = 4;  // points per pixel and axis

double paintAt(const CirclePicture& p, double x, double y) {
  const double dx = x - p.x;
  const double dy = y - p.y;
  const double u = static_cast<double>(p.shape.m[0]) * dx + static_cast<double>(p.shape.m[1]) * dy;
  const double v = static_cast<double>(p.shape.m[2]) * dx + static_cast<double>(p.shape.m[3]) * dy;
  // Distance from the outline, to first order: value over gradient. The border is one grid point
  // wide to avoid aliasing.
  const double q = std::sqrt(u * u + v * v);
  const double gx = (static_cast<double>(p.shape.m[0]) * u + static_cast<double>(p.shape.m[2]) * v);
  const double gy = (static_cast<double>(p.shape.m[1]) * u + static_cast<double>(p.shape.m[3]) * v);
  const double distance = q > 0 ? (q - 1) * q / std::sqrt(gx * gx + gy * gy) : -1;
  const double outside = std::clamp(0.5 + distance * kFine, 0.0, 1.0);
  double paint = p.around ? p.around(x, y) : 1.0;
  if (p.hole_distance > 0) {
    const double hx = dx - p.hole_distance * std::cos(p.sensor_hole);
    const double hy = dy - p.hole_distance * std::sin(p.sensor_hole);
    if (hx * hx + hy * hy < p.hole_radius * p.hole_radius) paint = 0.33;
  }
  return p.ratio + (paint - p.ratio) * outside;
}

std::vector<double> gaussian(double sigma) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& k : kernel) k /= sum;
  return kernel;
}

// Blurs along the rows and transposes; applied twice it is the two-dimensional blur.
std::vector<double> blurTurned(const std::vector<double>& in, int size,
                               const std::vector<double>& kernel) {
  const int reach = static_cast<int>(kernel.size() / 2);
  std::vector<double> out(in.size());
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      double sum = 0;
      for (int k = -reach; k <= reach; ++k) {
        const int from = std::clamp(column + k, 0, size - 1);
        sum += kernel[static_cast<std::size_t>(k + reach)] *
               in[static_cast<std::size_t>(row * size + from)];
      }
      out[static_cast<std::size_t>(column * size + row)] = sum;
    }
  }
  return out;
}

}  // namespace

std::vector<double> paintExact(const CirclePicture& p) {
  const int fine = p.size * kFine;
  std::vector<double> points(static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine));
  for (int row = 0; row < fine; ++row) {
    for (int column = 0; column < fine; ++column) {
      const double x = (column + 0.5) / kFine - 0.5;
      const double y = (row + 0.5) / kFine - 0.5;
      points[static_cast<std::size_t>(row * fine + column)] =
          p.white * paintAt(p, x, y) * (p.light ? p.light(x, y) : 1.0);
    }
  }
  const std::vector<double> kernel = gaussian(p.imaging.blur * kFine);
  points = blurTurned(blurTurned(points, fine, kernel), fine, kernel);
  std::vector<double> out(static_cast<std::size_t>(p.size) * static_cast<std::size_t>(p.size));
  for (int row = 0; row < fine; ++row) {
    for (int column = 0; column < fine; ++column) {
      out[static_cast<std::size_t>(row / kFine * p.size + column / kFine)] +=
          points[static_cast<std::size_t>(row * fine + column)] / (kFine * kFine);
    }
  }
  for (double& value : out) value += p.imaging.black;
  return out;
}

optics::GreyImage shoot(const CirclePicture& p, std::mt19937_64& random) {
  return shoot(p, paintExact(p), random);
}

optics::GreyImage shoot(const CirclePicture& p, const std::vector<double>& exact,
                        std::mt19937_64& random) {
  optics::GreyImage image(p.size, p.size);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double signal = (exact[i] - p.imaging.black) * (1 + p.grain * normal(random));
    const double sigma = std::sqrt(p.imaging.read_noise * p.imaging.read_noise +
                                   p.imaging.shot_gain * std::max(0.0, signal));
    const double value = signal + p.imaging.black + sigma * normal(random);
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
  }
  return image;
}

DiscShape roundShape(double radius, double stretch, double turn) {
  // Rotate the long axis onto x, divide by the half axes, rotate back.
  const double c = std::cos(turn);
  const double s = std::sin(turn);
  const double a = 1 / (radius * std::sqrt(stretch));
  const double b = std::sqrt(stretch) / radius;
  DiscShape shape;
  shape.m[0] = static_cast<float>(a * c * c + b * s * s);
  shape.m[1] = static_cast<float>((a - b) * c * s);
  shape.m[2] = shape.m[1];
  shape.m[3] = static_cast<float>(a * s * s + b * c * c);
  return shape;
}

double softStep(double distance, double width) {
  const double t = std::clamp(0.5 + 0.5 * distance / width, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace lab::detector::testing
