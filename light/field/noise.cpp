#include "light/field/noise.hpp"

#include <cmath>

#include "robot/dynamics/rng.hpp"

namespace lab::light {

namespace {

constexpr std::size_t kQuantiles = 1024;
constexpr unsigned kQuantileShift = 64 - 10;

/// Quantile of the standard normal distribution for `below` in (0, 1), by bisection.
double normalQuantile(double below) {
  double low = -8;
  double high = 8;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (normalShareBelow(middle) < below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Equally likely values that represent a standard normal distribution: the medians of 1024 equal
/// shares, scaled to variance 1.
std::array<double, kQuantiles> makeQuantiles() {
  std::array<double, kQuantiles> values{};
  double squares = 0;
  for (std::size_t k = 0; k < kQuantiles / 2; ++k) {
    const double z = normalQuantile((static_cast<double>(k) + 0.5) / kQuantiles);
    values[k] = z;
    values[kQuantiles - 1 - k] = -z;
    squares += 2 * z * z;
  }
  const double stretch = std::sqrt(kQuantiles / squares);
  for (double& value : values) value *= stretch;
  return values;
}

const std::array<double, kQuantiles>& quantiles() {
  static const std::array<double, kQuantiles> values = makeQuantiles();
  return values;
}

/// Quadratic B-spline weights of the lattice points before, nearest to and after a place `past`
/// (-1/2..1/2) beyond the nearest.
std::array<double, 3> weightsAt(double past) {
  const double before = 0.5 - past;
  const double after = 0.5 + past;
  return {0.5 * before * before, 0.75 - past * past, 0.5 * after * after};
}

/// std::floor(value + 0.5), without a library call.
std::int64_t nearestWhole(double value) {
  const double shifted = value + 0.5;
  const auto whole = static_cast<std::int64_t>(shifted);
  return whole - (static_cast<double>(whole) > shifted ? 1 : 0);
}

double sumOfSquares(const std::array<double, 3>& w) {
  return w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
}

}  // namespace

double normalShareBelow(double z) {
  const double x = std::abs(z);
  const double sum =
      1 +
      x * (0.0498673470 +
           x * (0.0211410061 +
                x * (0.0032776263 + x * (0.0000380036 + x * (0.0000488906 + x * 0.0000053830)))));
  const double square = sum * sum;
  const double fourth = square * square;
  const double eighth = fourth * fourth;
  const double tail = 0.5 / (eighth * eighth);
  return z < 0 ? tail : 1 - tail;
}

Noise::Noise(std::uint64_t seed, double phase) {
  const std::int64_t middle = nearestWhole(phase);
  shares_ = weightsAt(phase - static_cast<double>(middle));
  const double scale = 1 / std::sqrt(sumOfSquares(shares_));
  for (std::size_t k = 0; k < 3; ++k) {
    shares_[k] *= scale;
    std::uint64_t state = seed;
    state = dynamics::splitMix64(state) ^
            static_cast<std::uint64_t>(middle + static_cast<std::int64_t>(k) - 1);
    keys_[k] = dynamics::splitMix64(state);
  }
}

double Noise::normalAt(std::int64_t i, std::int64_t j) const {
  const std::uint64_t place = static_cast<std::uint64_t>(i) * 0xC2B2AE3D27D4EB4FULL +
                              static_cast<std::uint64_t>(j) * 0x165667B19E3779F9ULL;
  const std::array<double, kQuantiles>& values = quantiles();
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint64_t state = keys_[k] ^ place;
    sum += shares_[k] * values[dynamics::splitMix64(state) >> kQuantileShift];
  }
  return sum;
}

void NoiseReader::load(std::int64_t i, std::int64_t j) {
  loaded_ = true;
  i_ = i;
  j_ = j;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      around_[row][column] = noise_->normalAt(i + static_cast<std::int64_t>(column) - 1,
                                              j + static_cast<std::int64_t>(row) - 1);
    }
  }
}

double NoiseReader::at(double x, double y) {
  const std::int64_t i = nearestWhole(x);
  const std::int64_t j = nearestWhole(y);
  if (!loaded_ || i != i_ || j != j_) load(i, j);
  const std::array<double, 3> across = weightsAt(x - static_cast<double>(i));
  const std::array<double, 3> up = weightsAt(y - static_cast<double>(j));
  double sum = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    const std::array<double, 3>& z = around_[row];
    sum += up[row] * (across[0] * z[0] + across[1] * z[1] + across[2] * z[2]);
  }
  return normalShareBelow(sum / std::sqrt(sumOfSquares(across) * sumOfSquares(up)));
}

}  // namespace lab::light
