#include "tracker_svc/circle_fit/circle_fit_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lab::detector::fit {
namespace {

constexpr double kMostCorrelation = 0.5;  // [1] smoother structure is not visible in a window
constexpr double kLeastOdd = 0.25;  // [1] share of antisymmetric residuals below which they may be
                                    // chance, as with codec artefacts

/// Sums over the window: of all residuals, and of their antisymmetric half.
struct Halves {
  double all = 0;       // squares of the residuals
  double odd = 0;       // squares of the antisymmetric half
  double together = 0;  // products of neighbours in a row, antisymmetric half
};

/// Empty if the positions are not symmetric.
std::optional<Halves> halvesOf(const Window& window) {
  Halves out;
  double before = 0;
  for (int i = 0; i < window.places; ++i) {
    const int opposite = window.places - 1 - i;
    if (window.x[i] != -window.x[opposite] || window.y[i] != -window.y[opposite]) return {};
    const auto here = static_cast<double>(window.residual[i]);
    const double half = 0.5 * (here - static_cast<double>(window.residual[opposite]));
    out.all += here * here;
    out.odd += half * half;
    const bool adjoins =
        i > 0 && window.y[i] == window.y[i - 1] && window.x[i] == window.x[i - 1] + 1;
    if (adjoins) out.together += half * before;
    before = half;
  }
  return out;
}

}  // namespace

double antisymmetricCorrelation(const Window& window) {
  const std::optional<Halves> halves = halvesOf(window);
  if (!halves) return 1;
  return halves->all > 0 ? halves->together / halves->all : 0;
}

double varianceInflation(const Window& window, int pixels) {
  const std::optional<Halves> halves = halvesOf(window);
  if (!halves || !(halves->odd > 0)) return 1;
  // Half of the numbers are independent; the other half mirrors them.
  const double chance = std::sqrt(2.0) * static_cast<double>(correlationByChance(pixels));
  const double seen = halves->together / halves->odd;
  const double rho = seen > chance ? std::min(seen, kMostCorrelation) : 0.0;
  const double patch = (1 + rho) / (1 - rho);
  return std::max(kLeastOdd, 2 * halves->odd / halves->all) * patch * patch;
}

}  // namespace lab::detector::fit
