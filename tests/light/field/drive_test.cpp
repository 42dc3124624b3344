#include "light/field/drive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/light_samples.hpp"

namespace lab::light::drive_test {
namespace {

using testing::HasSubstr;
using testing::Optional;
using testing::StartsWith;

constexpr double kExact = 1e-12;

Drive telegraphOf(std::uint64_t seed) {
  return {.waveform = Waveform::kTelegraph, .period = 1, .seed = seed};
}

bool brightAt(const Drive& drive, double time) { return modulation(drive, time) == 1; }

/// Deviation of `hits` of `trials` from the probability p, in standard deviations.
double score(std::size_t hits, std::size_t trials, double p) {
  const double n = static_cast<double>(trials);
  return (static_cast<double>(hits) - n * p) / std::sqrt(n * p * (1 - p));
}

TEST(Modulation, OfASteadyLightIsOne) { EXPECT_EQ(modulation(Drive{}, 12.5), 1); }

TEST(Modulation, OfASineStartsAtItsCrest) {
  Drive dut{.waveform = Waveform::kSine, .period = 4};
  EXPECT_NEAR(modulation(dut, 0), 1, kExact);
  EXPECT_NEAR(modulation(dut, 1), 0.5, kExact);
  EXPECT_NEAR(modulation(dut, 2), 0, kExact);
  EXPECT_NEAR(modulation(dut, 400001), 0.5, 1e-9);
  dut.start = 0.5;
  EXPECT_NEAR(modulation(dut, 0), 0, kExact);
}

TEST(Modulation, OfASquareIsBrightInTheFirstHalf) {
  Drive dut{.waveform = Waveform::kSquare, .period = 2};
  EXPECT_EQ(modulation(dut, 0), 1);
  EXPECT_EQ(modulation(dut, 0.999), 1);
  EXPECT_EQ(modulation(dut, 1), 0);
  EXPECT_EQ(modulation(dut, 2), 1);
  dut.start = 0.75;
  EXPECT_EQ(modulation(dut, 0), 0);
  EXPECT_EQ(modulation(dut, 0.5), 1);
}

TEST(Telegraph, StartsBrightAndIsAFunctionOfSeedAndTime) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) EXPECT_TRUE(brightAt(telegraphOf(seed), 0));
  const Drive dut = telegraphOf(3);
  const double first = modulation(dut, 123.25);
  for (double time = 200; time > 0; time -= 7) (void)modulation(telegraphOf(4), time);
  EXPECT_EQ(modulation(telegraphOf(3), 123.25), first) << "no state between calls";
  Drive slower = dut;
  slower.period = 8;
  for (double time = 0; time < 100; time += 0.37) {
    EXPECT_EQ(modulation(dut, time), modulation(slower, 8 * time));
  }
}

// With changes at rate k = 2 / period, a telegraph signal is unchanged after time t (an even number
// of changes) with probability (1 + exp(-2 k t)) / 2, independent of its past. Times 10 periods
// apart are independent to exp(-40).
TEST(Telegraph, HasTheCorrelationOfARandomTelegraph) {
  constexpr std::size_t kTrials = 8000;
  const auto unchanged = [](double time) { return 0.5 + 0.5 * std::exp(-4 * time); };
  const Drive dut = telegraphOf(17);
  double largest = 0;
  for (const double offset : {0.0, 4.4, 9.7}) {  // the last one crosses block boundaries
    for (const double wait : {0.02, 0.1, 0.4, 1.0, 3.0}) {
      std::size_t bright = 0;
      std::size_t same = 0;
      std::size_t same_twice = 0;
      for (std::size_t i = 1; i <= kTrials; ++i) {
        const double time = 10 * static_cast<double>(i) + offset;
        const bool first = brightAt(dut, time);
        const bool second = brightAt(dut, time + wait);
        const bool third = brightAt(dut, time + wait + 0.1);
        bright += first ? 1 : 0;
        same += first == second ? 1 : 0;
        same_twice += first == second && second == third ? 1 : 0;
      }
      const double p = unchanged(wait);
      largest = std::max({largest, std::abs(score(bright, kTrials, 0.5)),
                          std::abs(score(same, kTrials, p)),
                          std::abs(score(same_twice, kTrials, p * unchanged(0.1)))});
    }
  }
  EXPECT_LT(largest, 4);
  RecordProperty("largest_z", std::to_string(largest));
}

// Sampled 200 times, so that only pairs of changes within a thousandth of a period are missed:
// probability 4e-4, compared with a standard deviation of 1e-2.
TEST(Telegraph, HasExponentialDwellTimes) {
  constexpr std::size_t kTrials = 2000;
  constexpr int kLooks = 200;
  double largest = 0;
  for (const double wait : {0.1, 0.2}) {
    std::size_t stayed = 0;
    for (std::size_t i = 0; i < kTrials; ++i) {
      const Drive dut = telegraphOf(i);
      bool same = true;
      for (int look = 1; look <= kLooks; ++look) same = same && brightAt(dut, wait * look / kLooks);
      stayed += same ? 1 : 0;
    }
    largest = std::max(largest, std::abs(score(stayed, kTrials, std::exp(-2 * wait))));
  }
  EXPECT_LT(largest, 4);
  RecordProperty("largest_z", std::to_string(largest));
}

TEST(Driven, MovesTurnsAndDims) {
  DrivenLayer dut;
  dut.layer = {.kind = LayerKind::kStripes, .x = 0.1, .y = 0.2, .angle = 1, .size = 0.1};
  dut.layer.inner = 0.5;
  dut.layer.intensity = 0.8;
  dut.drive = {.vx = 0.01, .vy = -0.02, .spin = 0.5};
  dut.drive.waveform = Waveform::kSine;
  dut.drive.period = 40;
  dut.drive.low = 0.2;
  const Layer shown = driven(dut, 10);
  EXPECT_NEAR(shown.x, 0.2, kExact);
  EXPECT_NEAR(shown.y, 0, kExact);
  EXPECT_NEAR(shown.angle, 6 - 2 * std::numbers::pi, kExact);
  EXPECT_NEAR(shown.intensity, 0.5, kExact);
  EXPECT_EQ(driven({dut.layer, {}}, 10), dut.layer);
}

TEST(Driven, WaveTravelsWithItsPhase) {
  DrivenLayer dut;
  dut.layer = {.kind = LayerKind::kWave, .size = 0.2, .phase = 0.5};
  dut.drive.phase_rate = 2;
  EXPECT_NEAR(driven(dut, 3).phase, 6.5, kExact);
}

// Over ten days every drive within the limits still gives a valid layer.
TEST(Driven, StaysValidForTheLongestRun) {
  for (const Layer& layer : oneOfEachKind()) {
    DrivenLayer dut{layer, {}};
    const bool placed = layer.kind != LayerKind::kUniform;
    const bool phased = layer.kind == LayerKind::kWave || layer.kind == LayerKind::kNoise;
    dut.drive.vx = placed ? kLargestSpeed : 0;
    dut.drive.vy = placed ? -kLargestSpeed : 0;
    dut.drive.spin = placed ? kLargestRate : 0;
    dut.drive.phase_rate = phased ? kLargestRate : 0;
    ASSERT_EQ(validate(dut.drive, layer.kind), std::nullopt) << static_cast<int>(layer.kind);
    for (const double time : {0.0, 1.0, 1e4, kLongestTime}) {
      EXPECT_EQ(validate(driven(dut, time)), std::nullopt) << static_cast<int>(layer.kind);
    }
  }
}

TEST(Driven, ImageSequenceRepeatsOrStops) {
  const auto image = makeImage(1, 1, {9});
  DrivenLayer dut;
  dut.layer = {.kind = LayerKind::kImage, .size = 1, .inner = 1};
  dut.layer.image = image->sha256;
  dut.layer.pixels = image;
  dut.drive.images = {image->sha256, "b", "c"};
  dut.drive.image_rate = 2;
  EXPECT_EQ(driven(dut, 0).image, image->sha256);
  EXPECT_EQ(driven(dut, 0.49).pixels, image);
  EXPECT_EQ(driven(dut, 0.5).image, "b");
  EXPECT_EQ(driven(dut, 0.5).pixels, nullptr);
  EXPECT_EQ(driven(dut, 1.5).image, image->sha256);
  EXPECT_EQ(driven(dut, 1e6).image, "c");  // 2 000 000 = 3 x 666 666 + 2
  dut.drive.image_loop = false;
  EXPECT_EQ(driven(dut, 1.5).image, "c");
  EXPECT_EQ(driven(dut, -1).image, image->sha256);
}

TEST(DriveValidate, AcceptsTheDefaultDriveForEveryKind) {
  for (const Layer& layer : oneOfEachKind()) EXPECT_EQ(validate(Drive{}, layer.kind), std::nullopt);
  EXPECT_EQ(validate(Drive{}, LayerKind::kFade), std::nullopt);
}

TEST(DriveValidate, RejectsEveryValueThatIsNotFinite) {
  const std::pair<const char*, double Drive::*> fields[] = {{"vx", &Drive::vx},
                                                            {"vy", &Drive::vy},
                                                            {"spin", &Drive::spin},
                                                            {"phase_rate", &Drive::phase_rate},
                                                            {"period", &Drive::period},
                                                            {"low", &Drive::low},
                                                            {"start", &Drive::start},
                                                            {"image_rate", &Drive::image_rate},
                                                            {"stale", &Drive::stale},
                                                            {"rate", &Drive::rate},
                                                            {"decay", &Drive::decay},
                                                            {"diffusion", &Drive::diffusion},
                                                            {"gate_x", &Drive::gate_x},
                                                            {"gate_y", &Drive::gate_y},
                                                            {"gate_radius", &Drive::gate_radius}};
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const auto& [name, member] : fields) {
      Drive dut;
      dut.*member = value;
      EXPECT_THAT(validate(dut, LayerKind::kWave), Optional(StartsWith(std::string(name) + " = ")));
    }
  }
}

TEST(DriveValidate, ReportsFoundAndAllowedValues) {
  const auto problem = [](const Drive& drive, LayerKind kind = LayerKind::kDisk) {
    return validate(drive, kind).value_or("none");
  };
  EXPECT_EQ(problem({.vx = 2}), "vx = 2 m/s, allowed: -1 to 1 m/s");
  EXPECT_EQ(problem({.vx = 0.1}, LayerKind::kUniform), "vx = 0.1 m/s, allowed: 0 m/s");
  EXPECT_EQ(problem({.phase_rate = 1}), "phase_rate = 1, allowed: 0");
  EXPECT_EQ(problem({.period = 0}), "period = 0 s, allowed: 0.001 to 864000 s");
  EXPECT_THAT(problem({.images = {"a"}}), HasSubstr("none where the layer is no image"));
  EXPECT_EQ(problem({.robots = {3, 0}}), "robots = 0, allowed: 1 to 10000");
  EXPECT_THAT(problem({.follow = Follow::kRobots}, LayerKind::kUniform),
              HasSubstr("0 where the layer has no place"));
  EXPECT_EQ(problem({.follow = Follow::kTrail}), "none");
  EXPECT_EQ(problem({.follow = Follow::kTrail}, LayerKind::kRing),
            "follow = 2, allowed: 0 or 1 where the layer is no disk");
  EXPECT_EQ(problem({.gate = Gate::kProgram}),
            "gate_program = \"\", allowed: the name of a program");
  EXPECT_EQ(problem({.gate = Gate::kInside}), "gate_radius = 0 m, allowed: 0.001 to 30 m");
  EXPECT_EQ(problem({.waveform = static_cast<Waveform>(9)}), "waveform = 9, allowed: 0 to 3");
  EXPECT_THAT(problem({.vx = 0.1}, LayerKind::kFade), HasSubstr("one that paints"));
}

}  // namespace
}  // namespace lab::light::drive_test
