#include "analyzer/laws/held_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "analyzer/laws/geometric_sums.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/saturated.hpp"

namespace lab::analysis {
namespace {

/// The Gauss rule for half of a symmetric integral that `count` points resolve. Cached, because
/// laws are built often.
const GaussRule& halfRule(int count) {
  thread_local std::map<int, GaussRule> rules;
  auto found = rules.find(count);
  if (found == rules.end()) {
    found = rules.emplace(count, gaussLegendre(count / 2 + 4)).first;
  }
  return found->second;
}

}  // namespace

HeldNoise HeldNoise::uniformTurning(double v, double eta, double epsilon) {
  return {Noise::kTurning, v, eta, 0, epsilon};
}

HeldNoise HeldNoise::uniformWheels(double va, double amplitude, double wheel_base, double epsilon) {
  return {Noise::kWheels, va, amplitude / wheel_base, amplitude, epsilon};
}

HeldNoise::HeldNoise(Noise noise, double va, double width, double amplitude, double epsilon)
    : noise_(noise),
      va_(va),
      width_(width),
      amplitude_(amplitude),
      epsilon_(epsilon),
      omega2_(noise == Noise::kTurning ? width * width / 3 : 2 * width * width / 3),
      q_(chi(epsilon)) {
  const int count = points();
  const GaussRule& rule = halfRule(count);
  // The integrands are symmetric about total / 2.
  const auto convolve = [&](double from, double total) {
    const double half = 0.5 * total - from;
    double sum = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double a = from + half * rule.nodes[i];
      sum += rule.weights[i] * chi(a) * chi(total - a);
    }
    return 2 * half * sum / epsilon_;
  };
  std::vector<double> first;
  std::vector<double> later;
  std::vector<double> spread;
  for (const double r : ChebyshevSeries::points(epsilon, count)) {
    const double inside = convolve(0, r);
    first.push_back((1 - r / epsilon_) * chi(r) + inside);
    later.push_back(q_ * inside + convolve(r, epsilon_ + r));
    spread.push_back((1 - r / epsilon_) * psi(r));
  }
  first_ = ChebyshevSeries(first, epsilon);
  later_ = ChebyshevSeries(later, epsilon);
  spread_ = ChebyshevSeries(spread, epsilon);
  first_once_ = first_.integral();
  first_twice_ = first_once_.integral();
  later_once_ = later_.integral();
  later_twice_ = later_once_.integral();
  spread_once_ = spread_.integral();
  spread_twice_ = spread_once_.integral();
}

int HeldNoise::points() const {
  // chi makes width * epsilon / (2 pi) oscillations in a hold, its square twice as many.
  const double more = 6 * width_ * epsilon_;
  return more < 182 ? 18 + saturated<int>(more) : 200;  // also if `more` is nan
}

double HeldNoise::chi(double t) const {
  const double a = sinc(width_ * t);
  return noise_ == Noise::kTurning ? a : a * a;
}

double HeldNoise::psi(double t) const {
  if (noise_ == Noise::kTurning) {
    return 0;
  }
  // V^2/2 (A'^2 - A A'') for A = sinc(k); the closed forms lose digits at small k.
  const double k = width_ * t;
  const double k2 = k * k;
  double slope = 0;
  double curvature = 0;
  if (k < 0.3) {
    slope = -k / 3 * (1 - k2 / 10 * (1 - k2 / 28 * (1 - k2 / 54 * (1 - k2 / 88))));
    curvature = -(1.0 / 3) *
                (1 - 3 * k2 / 10 * (1 - 5 * k2 / 84 * (1 - 7 * k2 / 270 * (1 - 9 * k2 / 616))));
  } else {
    slope = (std::cos(k) - sinc(k)) / k;
    curvature = -sinc(k) - 2 * slope / k;
  }
  return 0.5 * amplitude_ * amplitude_ * (slope * slope - sinc(k) * curvature);
}

double HeldNoise::meanSpeedPart(double tau) const {
  if (tau <= epsilon_) {
    return first_twice_(tau);
  }
  const double holds = std::floor(tau / epsilon_);
  const double rest = std::clamp(tau - holds * epsilon_, 0.0, epsilon_);
  const GeometricSums sums = geometricSums(q_, holds - 1);
  const double whole_once = later_once_(epsilon_);
  const double whole_twice = later_twice_(epsilon_);
  return first_twice_(epsilon_) + first_once_(epsilon_) * (tau - epsilon_) +
         sums.plain * (whole_twice + rest * whole_once) + sums.weighted * epsilon_ * whole_once +
         std::pow(q_, holds - 1) * later_twice_(rest);
}

double HeldNoise::msd(double tau) const {
  const double inside = std::min(tau, epsilon_);
  const double spread = spread_twice_(inside) + spread_once_(inside) * (tau - inside);
  return 2 * (va_ * va_ * meanSpeedPart(tau) + spread);
}

double HeldNoise::angularMsd(double tau) const {
  return tau <= epsilon_ ? omega2_ * tau * tau * (1 - tau / (3 * epsilon_))
                         : omega2_ * epsilon_ * (tau - epsilon_ / 3);
}

double HeldNoise::directionCorrelation(double s) const {
  if (s <= epsilon_) {
    return first_(s);
  }
  const double holds = std::floor(s / epsilon_);
  const double rest = std::clamp(s - holds * epsilon_, 0.0, epsilon_);
  return std::pow(q_, holds - 1) * later_(rest);
}

double HeldNoise::velocityCorrelation(double s) const {
  return va_ * va_ * directionCorrelation(s) + (s < epsilon_ ? spread_(s) : 0.0);
}

double HeldNoise::diffusivity() const {
  if (va_ == 0) {
    return 0.5 * spread_once_(epsilon_);
  }
  if (1 - q_ < 1e-15) {
    return std::numeric_limits<double>::infinity();
  }
  const double mean_part = first_once_(epsilon_) + later_once_(epsilon_) / (1 - q_);
  return 0.5 * (va_ * va_ * mean_part + spread_once_(epsilon_));
}

}  // namespace lab::analysis
