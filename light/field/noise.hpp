/// Smooth random patterns, bit-equal on every machine, from a seed, a place and a phase.
///
/// On a lattice of spacing 1 in x, y and phase there are independent standard normal values z. The
/// pattern is Phi(g), where g(p) = sum w(p - k) z_k / sqrt(sum w(p - k)^2) over the lattice points
/// k, w is the product of three quadratic B-splines (support 3, once differentiable) and Phi the
/// normal distribution function. So g is standard normal at every place, and the pattern is
///   * uniformly distributed over 0..1 at every place: mean 1/2, variance 1/12;
///   * correlated over the distance r and the phase difference s like
///     rho(r, s) = exp(-r^2 - s^2), within 0.04 in every direction (B-splines approximate
///     Gaussians): 1/e at distance 1, and exactly 0 where a coordinate differs by 3 or more. Phi
///     maps rho to (6 / pi) asin(rho / 2), 0.353 for rho = 1/e;
///   * continuous with its first derivatives.
#pragma once

#include <array>
#include <cstdint>

namespace lab::light {

/// A pattern at one phase.
class Noise {
 public:
  Noise() : Noise(0, 0) {}

  /// @param phase finite, |phase| below 1e15.
  Noise(std::uint64_t seed, double phase);

  /// Contribution of the lattice point (i, j) to g, summed over the phase.
  [[nodiscard]] double normalAt(std::int64_t i, std::int64_t j) const;

  bool operator==(const Noise&) const = default;

 private:
  std::array<std::uint64_t, 3> keys_{};  ///< of the three lattice planes around the phase
  std::array<double, 3> shares_{};       ///< weights of the planes; their squares add up to 1
};

/// Evaluates a pattern; fast if successive places are near each other.
class NoiseReader {
 public:
  /// @param noise must outlive the reader.
  explicit NoiseReader(const Noise& noise) : noise_(&noise) {}

  /// The pattern at (x, y), 0..1; coordinates in units of the correlation length, |x|, |y| below
  /// 1e15.
  [[nodiscard]] double at(double x, double y);

 private:
  void load(std::int64_t i, std::int64_t j);

  const Noise* noise_;
  bool loaded_ = false;
  std::int64_t i_ = 0;  ///< lattice point nearest to the previous place
  std::int64_t j_ = 0;
  std::array<std::array<double, 3>, 3> around_{};  ///< [row][column]
};

/// The normal distribution function, within 1.5e-7 (Abramowitz and Stegun 1964, 26.2.19). Uses only
/// sums, products and quotients, so that every machine gives the same bits.
[[nodiscard]] double normalShareBelow(double z);

}  // namespace lab::light
