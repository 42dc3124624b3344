#include "sim_svc/emulator/line_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::emulator {
namespace {

TEST(LineFaults, AHealthyLinePassesEveryByte) {
  LineFaults line({}, 1);
  for (int value = 0; value < 256; ++value) {
    const auto byte = line.pass(0, static_cast<std::uint8_t>(value), 1.0);
    ASSERT_TRUE(byte.has_value());
    EXPECT_EQ(byte->value, value);
    EXPECT_FALSE(byte->framing_error);
  }
  EXPECT_EQ(line.damaged(), 0U);
}

TEST(LineFaults, SpeedsWithinFourPercentAreReadCorrectly) {
  for (int value = 0; value < 256; ++value) {
    const LineByte byte{static_cast<std::uint8_t>(value), false};
    for (const double ratio : {0.96, 0.98, 1.0, 1.02, 1.04}) {
      EXPECT_EQ(sampleAt(byte, ratio).value, value) << ratio;
      EXPECT_FALSE(sampleAt(byte, ratio).framing_error) << ratio;
    }
  }
}

TEST(LineFaults, SpeedsSevenPercentApartAreGarbage) {
  for (const double ratio : {0.93, 1.07, 1.5, 0.6667, 4.0}) {
    int wrong = 0;
    for (int value = 0; value < 256; ++value) {
      const LineByte read = sampleAt({static_cast<std::uint8_t>(value), false}, ratio);
      wrong += read.value != value || read.framing_error ? 1 : 0;
    }
    EXPECT_GE(wrong, 100) << ratio;
  }
}

TEST(LineFaults, BitErrorsComeAtTheirRateAndFromTheirSeed) {
  LineFaultSettings settings;
  settings.bit_error_rate = 1e-3;
  settings.seed = 5;
  constexpr int kBytes = 200'000;
  const auto run = [&](std::uint64_t direction) {
    LineFaults line(settings, direction);
    std::vector<int> read;
    for (int i = 0; i < kBytes; ++i) {
      const auto byte = line.pass(0, static_cast<std::uint8_t>(i), 1.0);
      read.push_back(byte ? byte->value + (byte->framing_error ? 256 : 0) : -1);
    }
    return std::pair{read, line.damaged()};
  };
  const auto [read, damaged] = run(1);
  EXPECT_EQ(run(1).first, read);
  EXPECT_NE(run(2).first, read);
  // Ten bits per byte; five standard deviations.
  const double expected = kBytes * (1 - std::pow(1 - 1e-3, 10));
  EXPECT_NEAR(static_cast<double>(damaged), expected, 5 * std::sqrt(expected));
  int lost = 0;
  int unframed = 0;
  for (const int byte : read) {
    lost += byte < 0 ? 1 : 0;
    unframed += byte >= 256 ? 1 : 0;
  }
  EXPECT_NEAR(lost, kBytes * 1e-3, 5 * std::sqrt(kBytes * 1e-3));
  EXPECT_NEAR(unframed, kBytes * 1e-3, 5 * std::sqrt(kBytes * 1e-3));
}

TEST(LineFaults, AnUnpluggedCablePassesNothing) {
  LineFaultSettings settings;
  settings.outages = {{100, 200}, {300, 301}};
  LineFaults line(settings, 1);
  EXPECT_TRUE(line.pass(99, 1, 1.0).has_value());
  EXPECT_FALSE(line.pass(100, 1, 1.0).has_value());
  EXPECT_FALSE(line.pass(199, 1, 1.0).has_value());
  EXPECT_TRUE(line.pass(200, 1, 1.0).has_value());
  EXPECT_FALSE(line.pass(300, 1, 1.0).has_value());
  EXPECT_TRUE(line.pass(301, 1, 1.0).has_value());
}

}  // namespace
}  // namespace lab::emulator
