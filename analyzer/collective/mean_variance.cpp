#include "analyzer/collective/mean_variance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace lab::collective {
namespace {

constexpr std::size_t kCosines = 6;
constexpr std::size_t kMostFitted = 32;
constexpr double kLargestRatio = 2.5;

/// A spectrum of the family and what follows from it.
struct Spectrum {
  double lengths = 0;     ///< of the series in correlation times
  double of_mean = 0;     ///< variance of the mean, in units of the Lorentzian at frequency 0
  double of_cosines = 0;  ///< mean power of the six cosines
  std::array<double, kMostFitted> inverse{};
  std::array<double, kMostFitted> logarithms{};  ///< sum of the logarithms of the powers up to each
};

/// Series of 3 to 600 correlation times; a constant of 0 to 1 of the Lorentzian at frequency 0. The
/// last ones are flat at the fitted frequencies.
std::vector<Spectrum> family() {
  std::vector<Spectrum> all;
  for (double lengths = 3; lengths < 600; lengths *= 1.5) {
    for (const double constant : {0.0, 0.03, 0.1, 0.3, 1.0}) {
      Spectrum one;
      one.lengths = lengths;
      // Of an exponential autocorrelation, exactly.
      one.of_mean = 1 - (1 - std::exp(-lengths)) / lengths + constant;
      double logarithm = 0;
      for (std::size_t j = 0; j < kMostFitted; ++j) {
        // The cosine has (j + 1) / 2 periods.
        const double x = std::numbers::pi * static_cast<double>(j + 1) / lengths;
        const double power = 1 / (1 + x * x) + constant;
        if (j < kCosines) one.of_cosines += power / kCosines;
        one.inverse[j] = 1 / power;
        one.logarithms[j] = logarithm += std::log(power);
      }
      all.push_back(one);
    }
  }
  return all;
}

/// The cosines of 1/2, 1, 3/2 ... periods in a series of n values, one after the other.
std::vector<double> cosinesOf(std::size_t n, std::size_t count) {
  // cos(pi k / (2 n)) for all k of a period.
  std::vector<double> period(4 * n);
  for (std::size_t k = 0; k < period.size(); ++k) {
    period[k] = std::cos(std::numbers::pi * static_cast<double>(k) / (2 * static_cast<double>(n)));
  }
  std::vector<double> cosines;
  cosines.reserve(count * n);
  for (std::size_t j = 1; j <= count; ++j) {
    for (std::size_t i = 0; i < n; ++i) cosines.push_back(period[j * (2 * i + 1) % (4 * n)]);
  }
  return cosines;
}

/// The cosines for the lengths that time averages have. They are computed once, because the results
/// of a running lab need them hundreds of times a second.
std::vector<std::vector<double>> tabledCosines() {
  constexpr std::size_t kLongestTabled = 64;
  std::vector<std::vector<double>> all(kLongestTabled + 1);
  for (std::size_t n = kFewestBlocks; n <= kLongestTabled; ++n) all[n] = cosinesOf(n, kMostFitted);
  return all;
}

/// Squares of the coefficients of the first orthonormal cosines (DCT-II).
std::vector<double> powersOf(std::span<const double> series, std::size_t count) {
  static const std::vector<std::vector<double>> kTabled = tabledCosines();
  const std::size_t n = series.size();
  const std::vector<double> longer =
      n < kTabled.size() ? std::vector<double>() : cosinesOf(n, count);
  const std::vector<double>& cosines = n < kTabled.size() ? kTabled[n] : longer;
  std::vector<double> powers(count);
  for (std::size_t j = 0; j < count; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += series[i] * cosines[j * n + i];
    powers[j] = sum * sum * 2 / static_cast<double>(n);
  }
  return powers;
}

}  // namespace

MeanVariance varianceOfMean(std::span<const double> residuals) {
  static const std::vector<Spectrum> kFamily = family();
  MeanVariance result;
  if (residuals.size() < kFewestBlocks) return result;
  const std::size_t fitted = std::clamp<std::size_t>(residuals.size() / 2, 8, kMostFitted);
  const std::vector<double> powers = powersOf(residuals, fitted);

  // The amplitude of a spectrum is integrated out with the prior 1/amplitude.
  std::vector<double> logarithms;
  for (const Spectrum& one : kFamily) {
    double sum = 0;
    for (std::size_t j = 0; j < fitted; ++j) sum += powers[j] * one.inverse[j];
    logarithms.push_back(-0.5 * one.logarithms[fitted - 1] -
                         0.5 * static_cast<double>(fitted) * std::log(sum));
  }
  const double largest = *std::max_element(logarithms.begin(), logarithms.end());
  double total = 0;
  double ratio = 0;  // sums of logarithms
  double lengths = 0;
  for (std::size_t i = 0; i < kFamily.size(); ++i) {
    const double weight = std::exp(logarithms[i] - largest);
    total += weight;
    ratio += weight * std::log(kFamily[i].of_mean / kFamily[i].of_cosines);
    lengths += weight * std::log(kFamily[i].lengths);
  }
  ratio = std::max(1.0, std::exp(ratio / total));

  double power = 0;
  for (std::size_t j = 0; j < kCosines; ++j) power += powers[j] / kCosines;
  result.variance = ratio * power / static_cast<double>(residuals.size());
  result.degrees_of_freedom = kCosines;
  result.correlation_times = std::exp(lengths / total);
  result.is_long_enough = ratio <= kLargestRatio;
  return result;
}

}  // namespace lab::collective
