#include "analyzer/laws/bp_kurtosis.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analyzer/laws/geometric_sums.hpp"
#include "analyzer/laws/numerics.hpp"

namespace lab::analysis {

BpKurtosis::BpKurtosis(double amplitude, double wheel_base, double epsilon)
    : noise_(HeldNoise::uniformWheels(0, amplitude, wheel_base, epsilon)),
      epsilon_(epsilon),
      q2_(noise_.chi(2 * epsilon)) {
  // With u = d omega / 2 the speed is uniform in +-(V - |u|), and u has the density (V - |u|) /
  // V^2.
  const GaussRule rule = gaussLegendre(std::min(200, 24 + noise_.points()));
  std::vector<double> square;
  std::vector<double> turned;
  std::vector<double> fourth;
  for (const double t : ChebyshevSeries::points(epsilon, noise_.points())) {
    double sums[3] = {0, 0, 0};
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double rest = amplitude * (1 - rule.nodes[i]);
      const double half_turn = amplitude * rule.nodes[i] * t / wheel_base;
      const double weight = 2 * rule.weights[i] * rest / amplitude;
      const double chord2 = sinc(half_turn) * sinc(half_turn);
      sums[0] += weight * rest * rest / 3 * chord2;
      sums[1] += weight * rest * rest / 3 * chord2 * std::cos(2 * half_turn);
      sums[2] += weight * rest * rest * rest * rest / 5 * chord2 * chord2;
    }
    square.push_back(sums[0]);
    turned.push_back(sums[1]);
    fourth.push_back(sums[2]);
  }
  square_ = ChebyshevSeries(square, epsilon);
  turned_ = ChebyshevSeries(turned, epsilon);
  fourth_ = ChebyshevSeries(fourth, epsilon);
}

double BpKurtosis::ofWindow(double first, double holds, double last) const {
  struct Part {
    double square;
    double turned;
    double fourth;
  };
  const auto part = [this](double t) {
    const double t2 = t * t;
    return Part{square_(t) * t2, turned_(t) * t2, fourth_(t) * t2 * t2};
  };
  const Part a = part(first);
  const Part full_hold = part(epsilon_);
  const Part b = part(last);
  return a.fourth + holds * full_hold.fourth + b.fourth +
         4 * sumOverHoldPairs(a.square, full_hold.square, b.square, holds, 1) +
         2 * sumOverHoldPairs(a.turned, full_hold.turned, b.turned, holds, q2_);
}

double BpKurtosis::fourthMoment(double tau) const {
  static const GaussRule rule = gaussLegendre(24);
  const double holds = std::floor(tau / epsilon_);
  const double rest = std::clamp(tau - holds * epsilon_, 0.0, epsilon_);
  // By the time to the first update: if it is below `rest`, the window holds one more whole hold.
  double sum = 0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double early = rest * rule.nodes[i];
    sum += rule.weights[i] * rest * ofWindow(early, holds, rest - early);
    const double late = rest + (epsilon_ - rest) * rule.nodes[i];
    sum += rule.weights[i] * (epsilon_ - rest) *
           (holds > 0 ? ofWindow(late, holds - 1, rest + epsilon_ - late) : ofWindow(rest, 0, 0));
  }
  return sum / epsilon_;
}

double BpKurtosis::observed(double tau, double offset) const {
  const double r2 = noise_.msd(tau);
  const double seen2 = r2 + offset;
  return (fourthMoment(tau) + 4 * r2 * offset + 2 * offset * offset) / (seen2 * seen2);
}

}  // namespace lab::analysis
