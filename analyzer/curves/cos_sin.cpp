#include "analyzer/curves/cos_sin.hpp"

#include <bit>
#include <cstdint>
#include <numbers>

namespace lab::analysis {
namespace {

constexpr double kToInteger = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
// The first 33 bits of pi/2, so that multiples are exact, and the next 53.
constexpr double kHalfPi = 0x1.921fb544p+0;
constexpr double kHalfPiRest = 0x1.0b4611a626331p-34;

double sinNear0(double x, double x2) {
  return x + x * x2 *
                 (-1.66666666666666324348e-01 +
                  x2 * (8.33333333332248946124e-03 +
                        x2 * (-1.98412698298579493134e-04 +
                              x2 * (2.75573137070700676789e-06 +
                                    x2 * (-2.50507602534068634195e-08 +
                                          x2 * 1.58969099521155010221e-10)))));
}

double cosNear0(double x2) {
  return 1 - (0.5 * x2 - x2 * x2 *
                             (4.16666666666666019037e-02 +
                              x2 * (-1.38888888888741095749e-03 +
                                    x2 * (2.48015872894767294178e-05 +
                                          x2 * (-2.75573143513906633035e-07 +
                                                x2 * (2.08757232129817482790e-09 +
                                                      x2 * -1.13596475577881948265e-11))))));
}

}  // namespace

void cosSin(const double* angles, std::size_t n, double* cosines, double* sines) {
  for (std::size_t i = 0; i < n; ++i) {
    const double shifted = angles[i] * (2 * std::numbers::inv_pi) + kToInteger;
    const double quarters = shifted - kToInteger;
    const double rest = (angles[i] - quarters * kHalfPi) - quarters * kHalfPiRest;
    const auto sine = std::bit_cast<std::uint64_t>(sinNear0(rest, rest * rest));
    const auto cosine = std::bit_cast<std::uint64_t>(cosNear0(rest * rest));
    // No branches, so that the loop can be vectorised. Odd quarters swap sine and cosine; the
    // second bit of the quarter sets the sign.
    const auto quarter = std::bit_cast<std::uint64_t>(shifted);
    const std::uint64_t exchange = (sine ^ cosine) & (0 - (quarter & 1U));
    sines[i] = std::bit_cast<double>(sine ^ exchange ^ ((quarter & 2U) << 62U));
    cosines[i] = std::bit_cast<double>(cosine ^ exchange ^ (((quarter + 1) & 2U) << 62U));
  }
}

}  // namespace lab::analysis
