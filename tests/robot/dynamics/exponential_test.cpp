#include "robot/dynamics/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robot/dynamics/machine.hpp"

namespace lab::dynamics {
namespace {

constexpr double kUnit = 65536;

TEST(NegativeLog, IsTheLogarithmWithinThreeInAHundredThousand) {
  for (uint64_t bits = 1; bits < (1ULL << 32); bits += 8191) {
    const double u = std::ldexp(static_cast<double>(bits | 1U), -32);
    ASSERT_NEAR(negativeLog(static_cast<uint32_t>(bits)) / kUnit, -std::log(u), 3e-5) << bits;
  }
}

TEST(NegativeLog, HasBoundedResults) {
  EXPECT_NEAR(negativeLog(0) / kUnit, 32 * std::log(2.0), 3e-5);
  EXPECT_EQ(negativeLog(0xFFFFFFFFU), 0U);
}

TEST(NegativeLog, HasMeanAndMeanSquareOfTheExponentialLaw) {
  // Every 1021st of the 2^32 inputs: a deterministic quadrature, not a random sample.
  double sum = 0;
  double sum2 = 0;
  double n = 0;
  for (uint64_t bits = 510; bits < (1ULL << 32); bits += 1021) {
    const double e = negativeLog(static_cast<uint32_t>(bits)) / kUnit;
    sum += e;
    sum2 += e * e;
    ++n;
  }
  EXPECT_NEAR(sum / n, 1.0, 1e-4);
  EXPECT_NEAR(sum2 / n, 2.0, 4e-4);
}

/// Holds of exponential duration, which the machine rounds to the nearest millisecond.
class ExponentialHolds {
 public:
  ExponentialHolds(Fixed mean, uint64_t seed) : rng_(seed) {
    const uint32_t bits = static_cast<uint32_t>(mean);
    code_ = {kByteCodeFormat, 1, 0, 13, kPushByte, 0, kPushByte, 0, kPushLong};
    for (int shift = 0; shift < 32; shift += 8) {
      code_.push_back(static_cast<uint8_t>(bits >> shift));
    }
    code_.insert(code_.end(), {kExponential, kPushPlain, 0, kDrive, 0});
    EXPECT_EQ(checkByteCode(code_.data(), static_cast<uint16_t>(code_.size())).fault,
              kValidByteCode);
    machine_.start(code_.data(), static_cast<uint8_t>(code_.size()), inputs_, rng_);
  }

  uint32_t next() { return machine_.next(inputs_, rng_).duration_ms; }

 private:
  std::vector<uint8_t> code_;
  MachineInputs inputs_;
  Rng rng_;
  Machine machine_;
};

TEST(ExponentialHolds, HaveTheGivenMeanWithoutRoundingBias) {
  constexpr int kDraws = 10000000;
  for (const Fixed mean : {kOne, kOne / 3, kOne / 50}) {
    ExponentialHolds dut(mean, static_cast<uint64_t>(mean));
    double sum = 0;
    for (int i = 0; i < kDraws; ++i) {
      sum += dut.next();
    }
    const double mean_ms = mean * 1e3 / kOne;
    const double z = (sum / kDraws - mean_ms) / (mean_ms / std::sqrt(kDraws));
    // Rounding up would add 0.5 ms, which is z = 79 at the shortest of these means.
    EXPECT_LT(std::abs(z), 4) << mean_ms;
  }
}

TEST(ExponentialHolds, HaveTheExactDistribution) {
  constexpr int kDraws = 1000000;
  constexpr int kBins = 60;  // bins of 50 ms; the last one is open
  const double mean_ms = 500;
  ExponentialHolds dut(kOne / 2, 11);
  std::vector<double> count(kBins);
  for (int i = 0; i < kDraws; ++i) {
    ++count[std::min<size_t>(dut.next() / 50, kBins - 1)];
  }
  double chi2 = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    // A draw rounded to k ms represents times in [k - 1/2, k + 1/2).
    const double low = bin == 0 ? 0 : bin * 50 - 0.5;
    const double above = bin == kBins - 1 ? 0 : std::exp(-(bin * 50 + 49.5) / mean_ms);
    const double expected = kDraws * (std::exp(-low / mean_ms) - above);
    chi2 += std::pow(count[static_cast<size_t>(bin)] - expected, 2) / expected;
  }
  EXPECT_LT(std::abs(chi2 - (kBins - 1)) / std::sqrt(2.0 * (kBins - 1)), 4);
}

TEST(ExponentialHolds, DoNotOverflowAtALongMean) {
  ExponentialHolds dut(100 * kOne, 5);
  double sum = 0;
  for (int i = 0; i < 1000000; ++i) {
    const uint32_t ms = dut.next();
    ASSERT_LT(ms, 2300000U);
    sum += ms;
  }
  EXPECT_LT(std::abs(sum / 1e6 - 1e5) / 1e2, 4);
}

}  // namespace
}  // namespace lab::dynamics
