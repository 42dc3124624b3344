#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/analyzer/fits/fit_ensemble.hpp"
#include "tests/analyzer/paper_programs.hpp"

// One-hour recordings by the independent walker, as in the paper; the bounds hold if every draw of
// the wheels is known.

namespace lab::analysis {
namespace {

constexpr double kHour = 3600;

void print(const FitScatter& dut) {
  for (const auto& [name, number] : dut.numbers) {
    std::printf("%-5s bias %+.3f +- %.3f %%  sd %.3f %%  stated/sd %.3f  95 %% covers %.1f %%\n",
                name.c_str(), 100 * number.relative.mean(),
                100 * number.relative.deviation() / std::sqrt(number.relative.n),
                100 * number.relative.deviation(),
                number.sigma.mean() / number.relative.deviation(), 100 * dut.share(name));
  }
  std::printf("exact law rejected (p < 0.01): %d of %d, paper's: %d; chi2 p < 0.01: %d\n",
              dut.exact_rejected, dut.recordings, dut.paper_rejected, dut.unlikely);
}

void expectUnbiasedAtLimit(const FitScatter& dut, const char* name, double limit) {
  EXPECT_EQ(dut.refused, 0);
  EXPECT_LT(std::abs(dut.numbers.at(name).relative.mean()), 0.002) << name;
  EXPECT_LT(dut.sd(name), 1.1 * limit) << name;
  EXPECT_GE(dut.share(name), 0.93) << name;
  EXPECT_LE(dut.share(name), 0.97) << name;
}

TEST(LawFitEnsemble, Figure2bAThousandHours) {
  WalkerRecording recording = fitRecording(abpLaw(3, 0.5), kHour);
  recording.sigma_theta = 3 * std::numbers::pi / 180;
  const FitScatter dut = fitRecordings(recording, 1000, 70, false, true);
  print(dut);
  expectUnbiasedAtLimit(dut, "D_r", std::sqrt(0.8 * 0.5 / kHour));
  EXPECT_LE(dut.exact_rejected, 20);
  EXPECT_EQ(dut.paper_rejected, 1000);
}

TEST(LawFitEnsemble, Figure2bNested) {
  WalkerRecording recording = fitRecording(abpLaw(3, 0.5), kHour);
  recording.sigma_theta = 3 * std::numbers::pi / 180;
  const FitScatter dut = fitRecordings(recording, 50, 10, true, false);
  print(dut);
  EXPECT_GE(dut.share("D_r"), 0.86);  // 95 % less 3 sigma of 50 recordings
  // The stated error contains that of the robots' clocks.
  EXPECT_NEAR(dut.numbers.at("D_r").sigma.mean(),
              std::hypot(std::sqrt(0.8 * 0.5 / kHour), kClockError), 0.0011);
}

TEST(LawFitEnsemble, BrownianParticle) {
  WalkerRecording recording = fitRecording(noisyLaw(0, 0.07, 0.2), kHour);
  recording.fps = 19.97;
  const FitScatter dut = fitRecordings(recording, 400, 30, false, true);
  print(dut);
  EXPECT_LT(std::abs(dut.numbers.at("V").relative.mean()), 0.002);
  // sd(V^2) / V^2 = sqrt(0.8 / 2N) where all 2N draws of both wheels are known.
  EXPECT_LT(dut.sd("D_t"), 1.1 * std::sqrt(0.8 * 0.2 / (2 * kHour)));
  EXPECT_GE(dut.share("V"), 0.917);  // 95 % and 3 sigma of 400 recordings
  EXPECT_LE(dut.share("V"), 0.983);
}

TEST(LawFitEnsemble, RunAndTumble) {
  const FitScatter dut = fitRecordings(fitRecording(rtpLaw(1, 0.5), kHour), 200, 70, false, true);
  print(dut);
  EXPECT_LT(std::abs(dut.numbers.at("gamma").relative.z(0)), 4);
  EXPECT_LT(dut.sd("gamma"), 0.03);      // counting tumbles: 2.0 %
  EXPECT_GE(dut.share("gamma"), 0.904);  // of 200 recordings
  EXPECT_LE(dut.share("gamma"), 0.996);
  EXPECT_LE(dut.paper_rejected, 8);  // eq. 6 is exact
}

TEST(LawFitEnsemble, AbpOfFigure2dSlowAndFast) {
  for (const double eta : {1.0, 6.0}) {
    WalkerRecording recording = fitRecording(abpLaw(eta, 0.25), kHour);
    recording.sigma_theta = 0.005;
    const FitScatter dut = fitRecordings(recording, 300, 10, false, false);
    print(dut);
    EXPECT_LT(std::abs(dut.numbers.at("D_r").relative.mean()), 0.002) << eta;
    EXPECT_LT(dut.sd("D_r"), 1.1 * std::sqrt(0.8 * 0.25 / kHour)) << eta;
    EXPECT_GE(dut.share("D_r"), 0.912) << eta;  // of 300 recordings
    EXPECT_LE(dut.share("D_r"), 0.988) << eta;
  }
}

}  // namespace
}  // namespace lab::analysis
