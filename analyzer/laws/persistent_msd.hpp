#pragma once

#include <cmath>

namespace lab::analysis {

/// x - 1 + exp(-x), also at small x.
inline double persistentShape(double x) {
  return x < 1e-3 ? x * x / 2 * (1 - x / 3 * (1 - x / 4 * (1 - x / 5))) : x + std::expm1(-x);
}

/// The MSD of a velocity correlation c0 exp(-rate s).
inline double exponentialMsd(double c0, double rate, double tau) {
  return rate == 0 ? c0 * tau * tau : 2 * c0 / (rate * rate) * persistentShape(rate * tau);
}

}  // namespace lab::analysis
