#include "analyzer/laws/rtp_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analyzer/laws/numerics.hpp"

namespace lab::analysis {
namespace {

constexpr double kNothing = 1e-18;  // relative size of negligible terms

/// exp(-x) x^k / k!.
double poisson(double k, double x) {
  if (x <= 0) return k == 0 ? 1.0 : 0.0;
  int sign = 0;  // std::lgamma() writes it to a variable that all threads share
  return std::exp(k * std::log(x) - x - lgamma_r(k + 1, &sign));
}

/// E[(N - n)_+] of a Poisson number N with mean x, for n >= 1: summed over the shorter of the two
/// tails. All terms are positive.
double poissonExcess(double n, double x) {
  if (x < n) {
    double p = poisson(n + 1, x);
    double sum = 0;
    for (double m = n + 1;; ++m) {
      const double term = (m - n) * p;
      sum += term;
      if (term <= kNothing * sum) return sum;
      p *= x / (m + 1);
    }
  }
  double p = poisson(n - 1, x);
  double sum = x - n;
  for (double m = n - 1; m >= 0; --m) {
    const double term = (n - m) * p;
    sum += term;
    if (term <= kNothing * sum) break;
    p *= m / x;
  }
  return sum;
}

}  // namespace

Turning Turning::uniform(double low, double high) {
  return clipped(low, high, std::numeric_limits<double>::infinity());
}

Turning Turning::clipped(double low, double high, double limit) {
  const double width = high - low;
  const double a = std::clamp(low, -limit, limit);
  const double b = std::clamp(high, -limit, limit);
  Turning turning;
  if (!(width > 0)) {
    turning.mean = a;
    turning.mean_square = a * a;
    turning.z = std::polar(1.0, a);
    return turning;
  }
  const double inside = (b - a) / width;
  const double below = std::clamp((-limit - low) / width, 0.0, 1.0);
  const double above = std::clamp((high - limit) / width, 0.0, 1.0);
  turning.mean = inside * (a + b) / 2 + below * a + above * b;
  turning.mean_square = inside * (a * a + a * b + b * b) / 3 + below * a * a + above * b * b;
  turning.z = inside * sinc((b - a) / 2) * std::polar(1.0, (a + b) / 2) +
              below * std::polar(1.0, a) + above * std::polar(1.0, b);
  return turning;
}

RtpLaw::RtpLaw(double v, double gamma, double tau_t, const Turning& turning)
    : v_(v), gamma_(gamma), tau_t_(tau_t), turning_(turning), run_share_(1 / (1 + gamma * tau_t)) {}

double RtpLaw::doubleIntegral(std::complex<double> z, double tau) const {
  double sum = 0;
  double size = 0;
  std::complex<double> power = 1;
  for (double k = 0; k * tau_t_ < tau; ++k) {
    const double excess = poissonExcess(k + 1, gamma_ * (tau - k * tau_t_));
    sum += power.real() * excess;
    size += std::abs(power) * excess;
    power *= z;
    if (std::abs(power) * excess <= kNothing * size) break;
  }
  return sum;
}

double RtpLaw::msd(double tau) const {
  return 2 * v_ * v_ * run_share_ / (gamma_ * gamma_) * doubleIntegral(turning_.z, tau);
}

double RtpLaw::angularMsd(double tau) const {
  const double t = tau_t_;
  const double own = tau <= t ? tau * tau * (1 - tau / (3 * t)) / (t * t) : tau / t - 1.0 / 3;
  const double mean2 = turning_.mean * turning_.mean;
  const double scatter = (turning_.mean_square - mean2) * (1 - run_share_) * own;
  if (mean2 == 0) return scatter;
  // The mean turn is proportional to the time in tumbles, which is tau less the time in runs.
  const double tumbled2 = tau * tau * (1 - 2 * run_share_) +
                          2 * run_share_ / (gamma_ * gamma_) * doubleIntegral(1, tau);
  return scatter + mean2 * tumbled2 / (t * t);
}

double RtpLaw::velocityCorrelation(double s) const {
  double sum = 0;
  std::complex<double> power = 1;
  for (double k = 0; k * tau_t_ <= s && std::abs(power) > kNothing; ++k) {
    sum += power.real() * poisson(k, gamma_ * (s - k * tau_t_));
    power *= turning_.z;
  }
  return v_ * v_ * run_share_ * sum;
}

double RtpLaw::diffusivity() const { return v_ * run_share_ * persistenceLength() / 2; }

double RtpLaw::persistenceLength() const {
  const std::complex<double> kept = 1.0 - turning_.z;
  return kept == 0.0 ? std::numeric_limits<double>::infinity() : v_ / gamma_ * (1.0 / kept).real();
}

}  // namespace lab::analysis
