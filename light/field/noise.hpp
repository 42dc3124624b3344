/// Smooth random patterns: the same numbers on every machine, from a seed, a place and a phase.
///
/// On a lattice of spacing 1 in x, y and phase stand independent standard normal values z. The
/// pattern is Phi(g), where g(p) = sum w(p - k) z_k / sqrt(sum w(p - k)^2) over the lattice points
/// k, w is the product of three quadratic B-splines (support 3, once differentiable) and Phi the
/// normal distribution's function. So g is standard normal at every place, and the pattern is
///   * uniformly distributed over 0..1 at every place: mean 1/2, variance 1/12;
///   * correlated over the distance r and the phase difference s as close to
///     rho(r, s) = exp(-r^2 - s^2) as B-splines are to Gaussians (g; within 0.04, in every
///     direction): 1/e at distance 1, and exactly 0 where a coordinate differs by 3 or more. Phi
///     turns rho into (6 / pi) asin(rho / 2), 0.353 where rho = 1/e;
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

  /// g's part of the lattice point (i, j), already summed over the phase.
  [[nodiscard]] double normalAt(std::int64_t i, std::int64_t j) const;

  bool operator==(const Noise&) const = default;

 private:
  std::array<std::uint64_t, 3> keys_{};  ///< of the three patterns around the phase
  std::array<double, 3> shares_{};       ///< their squares add up to 1
};

/// Reads a pattern at places one after the other; it is fast while they stay near each other.
class NoiseReader {
 public:
  /// @param noise must outlive the reader.
  explicit NoiseReader(const Noise& noise) : noise_(&noise) {}

  /// The pattern at (x, y), 0..1; coordinates in units of the patches' size, |x|, |y| below 1e15.
  [[nodiscard]] double at(double x, double y);

 private:
  void load(std::int64_t i, std::int64_t j);

  const Noise* noise_;
  bool loaded_ = false;
  std::int64_t i_ = 0;  ///< the lattice point nearest to the place read last
  std::int64_t j_ = 0;
  std::array<std::array<double, 3>, 3> around_{};  ///< [row][column]
};

/// The normal distribution's function, within 1.5e-7 (Abramowitz and Stegun 1964, 26.2.19). Sums,
/// products and quotients only, so that every machine gets the same bits.
[[nodiscard]] double normalShareBelow(double z);

}  // namespace lab::light
