#include "analyzer/laws/phased_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analyzer/laws/geometric_sums.hpp"

namespace lab::analysis {

PhasedNoise::PhasedNoise(const HeldNoise& noise) : noise_(noise), q_(noise.chi(noise.epsilon())) {
  std::vector<double> chi;
  std::vector<double> psi;
  for (const double t : ChebyshevSeries::points(noise.epsilon(), noise.points())) {
    chi.push_back(noise.chi(t));
    psi.push_back(noise.psi(t));
  }
  chi_once_ = ChebyshevSeries(chi, noise.epsilon()).integral();
  chi_twice_ = chi_once_.integral();
  psi_twice_ = ChebyshevSeries(psi, noise.epsilon()).integral().integral();
}

PhasedNoise::Window PhasedNoise::window(double tau, double to_update) const {
  Window window;
  window.first = std::min(tau, to_update);
  const double behind = tau - window.first;
  window.holds = std::floor(behind / noise_.epsilon());
  window.last = std::clamp(behind - window.holds * noise_.epsilon(), 0.0, noise_.epsilon());
  return window;
}

double PhasedNoise::msd(double tau, double to_update) const {
  const double va2 = noise_.meanSpeed() * noise_.meanSpeed();
  const auto alone = [&](double t) { return va2 * chi_twice_(t) + psi_twice_(t); };
  const auto [first, holds, last] = window(tau, to_update);
  const double pairs =
      sumOverHoldPairs(chi_once_(first), chi_once_(noise_.epsilon()), chi_once_(last), holds, q_);
  return 2 * (alone(first) + holds * alone(noise_.epsilon()) + alone(last) + va2 * pairs);
}

double PhasedNoise::angularMsd(double tau, double to_update) const {
  const auto [first, holds, last] = window(tau, to_update);
  const double epsilon = noise_.epsilon();
  return noise_.meanSquareTurning() * (first * first + holds * epsilon * epsilon + last * last);
}

double PhasedNoise::velocityCorrelation(double s, double to_update) const {
  const double va2 = noise_.meanSpeed() * noise_.meanSpeed();
  const auto [first, holds, last] = window(s, to_update);
  if (s < to_update) return va2 * noise_.chi(s) + noise_.psi(s);
  return va2 * noise_.chi(first) * std::pow(q_, holds) * noise_.chi(last);
}

}  // namespace lab::analysis
