// p-values of recordings that follow their law are uniform.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/analyzer/fits/fit_ensemble.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis {
namespace {

constexpr double kHalfHour = 1800;

/// The p-value of the hypothesis that the values are uniform in [0, 1], by the asymptotic
/// distribution of Kolmogorov and Smirnov (Stephens 1970).
double uniformity(std::vector<double> values) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double distance = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, values[i] - below / n, (below + 1) / n - values[i]});
  }
  const double x = distance * (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n));
  double tail = 0;
  for (int k = 1; k < 100; ++k) tail += (k % 2 == 1 ? 2 : -2) * std::exp(-2 * k * k * x * x);
  return std::clamp(tail, 0.0, 1.0);
}

void print(const char* of, const std::vector<double>& values) {
  double mean = 0;
  int below_5 = 0;
  int below_1 = 0;
  for (const double p : values) {
    mean += p / static_cast<double>(values.size());
    below_5 += p < 0.05 ? 1 : 0;
    below_1 += p < 0.01 ? 1 : 0;
  }
  std::printf("%s: mean %.3f, below 0.05 / 0.01: %d / %d of %zu, KS p %.2g\n", of, mean, below_5,
              below_1, values.size(), uniformity(values));
}

void expectUniform(const ProgramLaw& law, double fps, double clock_error) {
  WalkerRecording recording = fitRecording(law, kHalfHour);
  recording.fps = fps;
  const FitScatter dut = fitRecordings(recording, 400, 30, false, true, clock_error, 20);
  EXPECT_EQ(dut.refused, 0);
  print("fit", dut.fit_p);
  print("exact law", dut.exact_p);
  EXPECT_GT(uniformity(dut.fit_p), 1e-3);
  EXPECT_GT(uniformity(dut.exact_p), 1e-3);
}

TEST(PValues, OfAbpAreUniform) { expectUniform(abpLaw(3, 0.5), 9.97, 0.005); }

TEST(PValues, OfNoisyAbpAreUniform) { expectUniform(noisyLaw(0.03, 0.07, 0.2), 19.97, 0.005); }

TEST(PValues, OfBpAreUniform) { expectUniform(noisyLaw(0, 0.07, 0.2), 19.97, 0.005); }

TEST(PValues, OfRtpAreUniform) { expectUniform(rtpLaw(1, 0.5), 9.97, 0.005); }

}  // namespace
}  // namespace lab::analysis
