#include "common/experiment/experiment_file.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <fstream>
#include <numbers>

#include "common/math/random.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab {
namespace {

using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string problemsOfFile(const std::filesystem::path& file) {
  try {
    static_cast<void>(loadExperiment(file));
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "none";
}

TEST(ExperimentFile, IsReadInSiUnits) {
  const Experiment dut = small(R"([programs.rtp]
model = "rtp"
v_cm_s = 5
gamma_per_s = 3
tau_t_s = 0.5
[camera]
delay_ms = 15
heading_noise_deg = 90
)");

  EXPECT_EQ(dut.name, "small");
  EXPECT_EQ(dut.duration, 60);
  EXPECT_EQ(test::parameter(dut.programs.at("abp"), "v"), 0.03);
  EXPECT_EQ(test::parameter(dut.programs.at("abp"), "eta"), 3);
  EXPECT_EQ(dut.programs.at("rtp").law.name, "rtp");
  EXPECT_EQ(dut.programs.at("rtp").hash, test::rtp(0.05, 3, 0.5).hash);
  EXPECT_EQ(dut.camera.delay, 0.015);
  EXPECT_EQ(dut.camera.heading_noise, std::numbers::pi / 2);
}

TEST(ExperimentFile, KeepsTheDefaultsOfMissingKeys) {
  const Experiment dut = small();

  const Experiment defaults;
  EXPECT_EQ(dut.seed, defaults.seed);
  EXPECT_EQ(dut.network, defaults.network);
  EXPECT_EQ(dut.hardware, defaults.hardware);
  EXPECT_EQ(dut.reversal, defaults.reversal);
  EXPECT_EQ(dut.camera, defaults.camera);
  EXPECT_EQ(dut.analysis, defaults.analysis);
  EXPECT_EQ(dut.faults, defaults.faults);
}

TEST(ExperimentFile, ExpandsAProgramWithoutALightTable) {
  const Experiment dut = small();

  EXPECT_THAT(dut.light_table.bands, ElementsAre(LightBand{0, 1, "abp"}));
  ASSERT_THAT(dut.light.steps, SizeIs(1));
  ASSERT_THAT(dut.light.steps[0].layers, SizeIs(1));
  EXPECT_EQ(dut.light.steps[0].layers[0].intensity, 0.5);
  const std::string written = writeExperiment(dut);
  EXPECT_THAT(written, Not(HasSubstr("\nprogram = ")));
  EXPECT_THAT(written, HasSubstr("{light = [0, 1], program = \"abp\"}"));
}

TEST(ExperimentFile, ExpandsCountsAndSortsRobotsById) {
  const Experiment dut = small(R"([[robots]]
id = 20
count = 2
[[robots]]
id = 3
x_cm = 30
y_cm = 40
theta_deg = 180
)");

  const auto id = [](std::int32_t value) { return Field(&RobotSpec::id, Eq(value)); };
  EXPECT_THAT(dut.robots, ElementsAre(id(1), id(3), id(20), id(21)));
  EXPECT_EQ(dut.robots[1].start, (StartPose{0.3, 0.4, std::numbers::pi}));
  EXPECT_FALSE(dut.robots[2].start.has_value());
}

TEST(ExperimentFile, AddsUpHoldTimesToTheMicrosecond) {
  const Experiment dut = small(R"([light]
repeat = true
[[light.steps]]
hold_s = 0.1
layers = [{kind = "uniform", intensity = 0}]
[[light.steps]]
hold_s = 0.2
layers = [{kind = "uniform", intensity = 1}]
[[light.steps]]
hold_s = 0.3
label = "last"
layers = [{kind = "uniform", intensity = 1}]
)");

  ASSERT_THAT(dut.light.steps, SizeIs(3));
  EXPECT_EQ(dut.light.steps[1].at, 0.1);
  EXPECT_EQ(dut.light.steps[2].at, 0.3);
  EXPECT_EQ(dut.light.length, 0.6);
  EXPECT_EQ(dut.light.steps[1].label, "step 2");
  EXPECT_EQ(dut.light.steps[2].label, "last");
}

TEST(ExperimentFile, AllowsARepeatedPassLongerThanTheRun) {
  const Experiment dut = small(R"([light]
repeat = true
length_s = 200
[[light.steps]]
at_s = 0
layers = [{kind = "uniform", intensity = 0}]
[[light.steps]]
at_s = 100
layers = [{kind = "uniform", intensity = 1}]
)");

  EXPECT_EQ(dut.light.length, 200);
}

TEST(ExperimentFile, SetsTheFieldsOfEveryKindOfLayer) {
  const Experiment dut = small(R"([[light.steps]]
at_s = 0
layers = [
  {kind = "uniform", intensity = 0.1},
  {kind = "half_plane", angle_deg = 90, softness_cm = 1, intensity = 0.2},
  {kind = "disk", x_cm = 10, y_cm = 20, radius_cm = 5, intensity = 0.3, blend = "add"},
  {kind = "ring", radius_cm = 9, inner_radius_cm = 4, intensity = 0.4, blend = "max"},
  {kind = "linear_gradient", length_cm = 120, intensity = 0, intensity2 = 1},
  {kind = "radial_gradient", radius_cm = 45, intensity = 1, blend = "multiply"},
  {kind = "stripes", period_cm = 10, share = 0.25, intensity = 1, blend = "min"},
  {kind = "checker", period_cm = 12, intensity = 1},
  {kind = "image", file = "logo.png", width_cm = 30, height_cm = 20, intensity = 1},
]
)");

  const auto& layers = dut.light.steps.at(0).layers;
  ASSERT_THAT(layers, SizeIs(9));
  EXPECT_EQ(layers[0].x, 0);
  EXPECT_EQ(layers[1].x, 0.6);
  EXPECT_EQ(layers[1].y, 0.45);
  EXPECT_EQ(layers[1].angle, std::numbers::pi / 2);
  EXPECT_EQ(layers[2].x, 0.1);
  EXPECT_EQ(layers[2].size, 0.05);
  EXPECT_EQ(layers[2].blend, 1);
  EXPECT_EQ(layers[3].inner, 0.04);
  EXPECT_EQ(layers[4].size, 1.2);
  EXPECT_EQ(layers[4].intensity2, 1);
  EXPECT_EQ(layers[5].blend, 2);
  EXPECT_EQ(layers[6].inner, 0.25);
  EXPECT_EQ(layers[7].size, 0.12);
  EXPECT_EQ(layers[8].inner, 0.2);
  EXPECT_EQ(layers[8].image, "logo.png");
  for (std::size_t i = 0; i < layers.size(); ++i) EXPECT_EQ(layers[i].kind, i + 1);
  EXPECT_EQ(parseExperiment(writeExperiment(dut), "written"), dut);
}

TEST(ExperimentFile, IsReadBackExactlyAsWritten) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const auto set = [&](const char* key, double low, double high) {
      return std::string(key) + "=" + std::to_string(low + (high - low) * random.uniform());
    };
    const Experiment dut =
        small({}, {set("robots[0].x_cm", 10, 110), set("robots[0].y_cm", 10, 80),
                   set("robots[0].theta_deg", -180, 180), set("robot.diameter_cm", 5, 9),
                   set("programs.abp.v_cm_s", -5, 5), set("camera.heading_noise_deg", 0, 3),
                   set("robot.clock_error_percent", 0, 5), set("camera.delay_ms", 0, 100),
                   set("duration_s", 10, 1000), set("light_table.hysteresis", 0, 0.5)});
    const std::string written = writeExperiment(dut);
    const Experiment back = parseExperiment(written, "written");
    EXPECT_EQ(back, dut);
    EXPECT_EQ(writeExperiment(back), written);
  }
}

TEST(ExperimentFile, KeepsTextThatNeedsEscaping) {
  const Experiment dut =
      small({}, {"description=\"two\\nlines, \\\"quotes\\\", \\\\ and \\u00fc\""});

  EXPECT_EQ(dut.description, "two\nlines, \"quotes\", \\ and \xc3\xbc");
  EXPECT_EQ(parseExperiment(writeExperiment(dut), "written").description, dut.description);
}

TEST(ExperimentFile, WritesRobotsThatDifferOnlyInTheirIdsAsOneEntry) {
  const std::string written = writeExperiment(small({}, {"robots[0].count=100"}));

  EXPECT_THAT(written, HasSubstr("[[robots]]\nid = 1\ncount = 100\n"));
}

TEST(ExperimentFile, AllowsARobotToTouchTheWall) {
  const Experiment dut =
      small({}, {"robots[0].x_cm=116.25", "robots[0].y_cm=3.75", "robots[0].theta_deg=0"});

  const double radius = dut.hardware.diameter / 2;
  ASSERT_TRUE(dut.robots[0].start.has_value());
  EXPECT_LE(dut.robots[0].start->x, dut.arena_width - radius);
  EXPECT_NEAR(dut.robots[0].start->x, 1.1625, 1e-15);
  EXPECT_GE(dut.robots[0].start->y, radius);
}

TEST(ExperimentFile, AcceptsTheWholeRangeOfSeeds) {
  EXPECT_EQ(small({}, {"seed=0"}).seed, 0U);
  EXPECT_EQ(small({}, {"seed=9223372036854775807"}).seed, 9223372036854775807U);
}

TEST(ExperimentFile, ThatIsMissingOrADirectoryOrEmptyOrHugeOrNoTextIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(problemsOfFile(folder / "none.toml"), HasSubstr("none.toml: found no such file"));
  EXPECT_THAT(problemsOfFile(folder / "."), HasSubstr("found a directory"));
  EXPECT_THAT(problemsOfFile("/dev/null"), HasSubstr("/dev/null: found a device, expected"));
  support::writeFile(folder / "empty.toml", " \n\t\n");
  EXPECT_THAT(problemsOfFile(folder / "empty.toml"), HasSubstr("empty.toml: found an empty file"));
  support::writeFile(folder / "huge.toml", std::string(1'000'001, '#'));
  EXPECT_THAT(problemsOfFile(folder / "huge.toml"),
              HasSubstr("huge.toml: found 1000001 bytes, allowed at most 1000000"));
  support::writeFile(folder / "binary.toml", std::string("\x7f\x45LF\x02\x00\xff\xfe", 8));
  EXPECT_THAT(problemsOfFile(folder / "binary.toml"),
              HasSubstr("binary.toml:1:6: found no valid TOML"));
  support::writeFile(folder / "deep.toml", "a = " + std::string(100'000, '['));
  EXPECT_THAT(problemsOfFile(folder / "deep.toml"), HasSubstr("deep.toml:1:"));
}

TEST(ExperimentFile, FindsImagesInItsFolder) {
  const TemporaryFolder folder;
  const std::string light =
      "[[light.steps]]\nat_s = 0\nlayers = [{kind = \"image\", file = \"dot.pgm\", width_cm = 30, "
      "height_cm = 30, intensity = 1}]\n";
  support::writeFile(folder / "x.toml", std::string(kSmall) + light);

  EXPECT_THAT(problemsOfFile(folder / "x.toml"),
              HasSubstr("light.steps[0].layers[0].file: found \"dot.pgm\" (no such file)"));
  support::writeFile(folder / "dot.pgm", "P5 1 1 255\nx");
  EXPECT_EQ(problemsOfFile(folder / "x.toml"), "none");
  support::writeFile(folder / "dot.pgm", "no image");
  EXPECT_THAT(problemsOfFile(folder / "x.toml"), HasSubstr("found \"dot.pgm\" (is not an image"));
}

}  // namespace
}  // namespace lab
