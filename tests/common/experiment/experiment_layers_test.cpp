// Layers that change with time and with robots: reading, evaluating and writing.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "common/math/random.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab {
namespace {

using light::Drive;
using light::LayerKind;
using testing::ElementsAre;
using testing::HasSubstr;

/// @param layers may contain line ends
std::string withLayers(std::string layers) {
  std::ranges::replace(layers, '\n', ' ');
  return "[[light.steps]]\nat_s = 0\nlayers = [" + layers + "]\n";
}

LayerSpec layerOf(const std::string& text) {
  return small(withLayers(text)).light.steps.at(0).layers.at(0);
}

void expectRoundTrip(const Experiment& experiment) {
  const std::string written = writeExperiment(experiment);
  EXPECT_EQ(parseExperiment(written, "written"), experiment) << written;
  EXPECT_EQ(writeExperiment(parseExperiment(written, "written")), written);
}

TEST(ExperimentLayers, NoiseHasPatchesASeedAndARateOfChange) {
  const LayerSpec dut =
      layerOf(R"({kind = "noise", patch_cm = 8, seed = 7, change_per_s = 0.25, intensity = 0.9})");
  EXPECT_EQ(dut.kind, static_cast<int>(LayerKind::kNoise));
  EXPECT_EQ(dut.size, 0.08);
  EXPECT_EQ(dut.seed, 7U);
  EXPECT_EQ(dut.drive, (Drive{.phase_rate = 0.25}));
}

// A crest of a wave with 6 cm/s has moved by 6 cm after a second.
TEST(ExperimentLayers, WaveTravelsAtItsSpeed) {
  const LayerSpec dut =
      layerOf(R"({kind = "wave", period_cm = 30, speed_cm_s = 6, intensity = 1})");
  EXPECT_EQ(dut.size, 0.3);
  EXPECT_NEAR(dut.drive.phase_rate * dut.size / (2 * std::numbers::pi), 0.06, 1e-15);
}

TEST(ExperimentLayers, MoveRotateAndDim) {
  const LayerSpec dut = layerOf(R"({kind = "disk", radius_cm = 5, intensity = 1, vx_cm_s = 2,
vy_cm_s = -1, spin_deg_s = 90, waveform = "telegraph", period_s = 4, low = 0.3, start = 0.5,
seed = 3})");
  Drive expected{.vx = 0.02, .vy = -0.01, .spin = std::numbers::pi / 2};
  expected.waveform = light::Waveform::kTelegraph;
  expected.period = 4;
  expected.low = 0.3;
  expected.start = 0.5;
  expected.seed = 3;
  EXPECT_EQ(dut.drive, expected);
  EXPECT_EQ(dut.seed, 0U);
}

TEST(ExperimentLayers, ShowImagesInSequence) {
  const LayerSpec dut = layerOf(R"({kind = "image", files = ["a.png", "b.png"], images_per_s = 4,
loop = false, width_cm = 30, height_cm = 20, intensity = 1})");
  EXPECT_EQ(dut.image, "a.png");
  EXPECT_THAT(dut.drive.images, ElementsAre("a.png", "b.png"));
  EXPECT_EQ(dut.drive.image_rate, 4);
  EXPECT_FALSE(dut.drive.image_loop);
}

TEST(ExperimentLayers, FollowRobotsInTheirFrame) {
  const LayerSpec dut = layerOf(R"({kind = "disk", radius_cm = 5, intensity = 1,
follow = "robots", robots = [1], predict = false, stale_s = 2, when_lost = "safe", x_cm = 3})");
  Drive expected{.follow = light::Follow::kRobots, .robots = {1}, .predict = false, .stale = 2};
  expected.when_lost = light::WhenLost::kSafe;
  EXPECT_EQ(dut.drive, expected);
  EXPECT_EQ(dut.x, 0.03);
  EXPECT_EQ(dut.y, 0);  // not the middle of the arena
}

TEST(ExperimentLayers, LeaveTrails) {
  const LayerSpec dut = layerOf(R"({kind = "disk", radius_cm = 5, intensity = 1,
follow = "trail", rate_per_s = 2, decay_per_s = 0.5, diffusion_cm2_s = 4})");
  EXPECT_EQ(dut.drive.follow, light::Follow::kTrail);
  EXPECT_EQ(dut.drive.rate, 2);
  EXPECT_EQ(dut.drive.decay, 0.5);
  EXPECT_EQ(dut.drive.diffusion, 4e-4);
}

TEST(ExperimentLayers, AreGatedByRobots) {
  const LayerSpec by_program =
      layerOf(R"({kind = "uniform", intensity = 1, gate = "program", gate_program = "abp"})");
  EXPECT_EQ(by_program.drive.gate, light::Gate::kProgram);
  EXPECT_EQ(by_program.drive.gate_program, "abp");
  const LayerSpec by_place = layerOf(R"({kind = "uniform", intensity = 1, gate = "outside",
gate_robot = 1, gate_x_cm = 60, gate_y_cm = 45, gate_radius_cm = 20})");
  EXPECT_EQ(by_place.drive.gate, light::Gate::kOutside);
  EXPECT_EQ(by_place.drive.gate_robot, 1);
  EXPECT_EQ(by_place.drive.gate_x, 0.6);
  EXPECT_EQ(by_place.drive.gate_y, 0.45);
  EXPECT_EQ(by_place.drive.gate_radius, 0.2);
}

TEST(ExperimentLayers, UseTheLightOfAProgram) {
  const Experiment dut = parseExperiment(R"(fileversion = 1
name = "bands"
duration_s = 60
[[robots]]
id = 1
[programs.low]
model = "stand"
[programs.high]
model = "bp"
V_cm_s = 7
epsilon_s = 0.2
[light_table]
bands = [{light = [0.1, 0.3], program = "low"}, {light = [0.5, 1], program = "high"}]
[[light.steps]]
at_s = 0
layers = [{kind = "uniform", program = "high"}, {kind = "disk", radius_cm = 9, program = "low"}]
)",
                                         "bands.toml");
  EXPECT_EQ(dut.light.steps[0].layers[0].intensity, 0.75);
  EXPECT_EQ(dut.light.steps[0].layers[1].intensity, 0.2);
  expectRoundTrip(dut);
}

TEST(ExperimentLayers, ThatDoNotChangeAreWrittenWithoutDriveKeys) {
  const std::string written =
      writeExperiment(small(withLayers(R"({kind = "disk", radius_cm = 5, intensity = 1})")));
  EXPECT_THAT(written, HasSubstr("  {kind = \"disk\", blend = \"over\", x_cm = 60, y_cm = 45, "
                                 "radius_cm = 5, softness_cm = 0, intensity = 1},\n"));
}

TEST(ExperimentLayers, AreReadBackAsWritten) {
  expectRoundTrip(small(withLayers(R"(
{kind = "noise", patch_cm = 8, seed = 7, change_per_s = 0.25, intensity = 0.9, waveform = "sine",
 period_s = 3},
{kind = "image", files = ["a.png", "b \"c\".png"], images_per_s = 4, loop = false, width_cm = 30,
 height_cm = 20, intensity = 1},
{kind = "disk", radius_cm = 5, intensity = 1, follow = "robots", robots = [1], spin_deg_s = 10,
 gate = "inside", gate_x_cm = 1, gate_y_cm = 2, gate_radius_cm = 3, waveform = "telegraph",
 period_s = 4, seed = 9223372036854775807},
{kind = "disk", radius_cm = 5, intensity = 1, follow = "trail", diffusion_cm2_s = 3.3},
{kind = "uniform", intensity = 1, gate = "program", gate_program = "abp"}
)")));
  Random random(8);
  for (int i = 0; i < 300; ++i) {  // the file has a wave's speed, the layer the rate of its phase
    const std::string layer =
        "{kind = \"wave\", period_cm = " + std::to_string(1 + 99 * random.uniform()) +
        ", speed_cm_s = " + std::to_string(20 * random.uniform() - 10) +
        ", angle_deg = 33, intensity = 1}";
    expectRoundTrip(small(withLayers(layer)));
  }
}

// They must give one line with the location, whatever the numbers are.
TEST(ExperimentLayers, WithAbsurdNumbersAreRefused) {
  std::string million;
  for (int i = 0; i < 25'000; ++i) million += "{kind = \"uniform\", intensity = 1},";
  EXPECT_THAT(problemsOf(withLayers(million)),
              ElementsAre(HasSubstr("light.steps[0].layers: found 25000, allowed 1 to " +
                                    std::to_string(light::kMostLayers))));
  for (int i = 0; i < 10; ++i) million += million.substr(0, 100'000);
  EXPECT_THAT(problemsOf(withLayers(million)), ElementsAre(HasSubstr("allowed at most 1000000")));
}

}  // namespace
}  // namespace lab
