#include "runner/film/light_preview.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/experiment/experiment_file.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/movie_writer.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

Experiment scriptOf(const std::string& steps) {
  return parseExperiment(R"(fileversion = 1
name = "preview"
duration_s = 100
program = "stand"
[[robots]]
id = 1
x_cm = 30
y_cm = 30
theta_deg = 90
[programs.stand]
model = "stand"
)" + steps,
                         "preview.toml");
}

std::string step(double at, const std::string& layers, double ramp = 0) {
  return "[[light.steps]]\nat_s = " + std::to_string(at) + "\nramp_s = " + std::to_string(ramp) +
         "\nlayers = [" + layers + "]\n";
}

constexpr const char* kBright = R"({kind = "uniform", intensity = 0.8})";
constexpr const char* kDark = R"({kind = "uniform", intensity = 0.2})";

TEST(LightPreview, ShowsAConstantStepOnceAndAMovingOneFourTimes) {
  const Experiment experiment =
      scriptOf(step(0, kBright) +
               step(10, R"({kind = "wave", period_cm = 40, speed_cm_s = 8, intensity = 1})") +
               step(90, R"({kind = "disk", radius_cm = 9, vx_cm_s = 0.1, intensity = 1})", 2));
  LightPreview dut(experiment, {});
  ASSERT_EQ(dut.steps(), 3U);
  EXPECT_EQ(dut.length(0), 10);
  EXPECT_EQ(dut.length(2), 10);  // to the end of the run
  EXPECT_EQ(dut.moments(0), std::vector<double>{0});
  EXPECT_EQ(dut.span(0), 0);
  EXPECT_NEAR(dut.span(1), 5, 1e-12);  // a period of 40 cm at 8 cm/s
  ASSERT_EQ(dut.moments(1).size(), 4U);
  EXPECT_NEAR(dut.moments(1)[1], 1.25, 1e-12);
  EXPECT_EQ(dut.moments(2).front(), 2);  // after the ramp
  EXPECT_EQ(dut.moments(2).back(), 8);
}

TEST(LightPreview, FadesFromThePreviousStep) {
  const Experiment experiment = scriptOf(step(0, kBright) + step(10, kDark, 4));
  LightPreview dut(experiment, {});
  EXPECT_NEAR(light::evaluate(dut.field(1, 1), 0.5, 0.5), 0.65, 1e-12);
  EXPECT_NEAR(light::evaluate(dut.field(1, 4), 0.5, 0.5), 0.2, 1e-12);
}

TEST(LightPreview, DrawsFollowersAndTrailsAtTheStartPoses) {
  const Experiment experiment = scriptOf(
      step(0, R"({kind = "disk", radius_cm = 3, x_cm = 10, follow = "robots", intensity = 1})") +
      step(50,
           R"({kind = "disk", radius_cm = 6, follow = "trail", decay_per_s = 0, intensity = 1})"));
  LightPreview dut(experiment, {});
  const light::Field spot = dut.field(0, 1);
  EXPECT_EQ(light::evaluate(spot, 0.3, 0.4), 1);  // 10 cm ahead of a robot with heading along y
  EXPECT_EQ(light::evaluate(spot, 0.3, 0.3), 0);
  EXPECT_LT(light::evaluate(dut.field(1, 0), 0.3, 0.3), 0.1);
  EXPECT_GT(light::evaluate(dut.field(1, 5), 0.3, 0.3), 0.9);
  EXPECT_LT(light::evaluate(dut.field(1, 5), 0.6, 0.6), 0.01);
}

TEST(LightPreview, OpensGatesOnAProgram) {
  const Experiment experiment = scriptOf(
      step(0, R"({kind = "uniform", intensity = 0.7, gate = "program", gate_program = "stand"})"));
  LightPreview dut(experiment, {});
  EXPECT_EQ(light::evaluate(dut.field(0, 0), 0.5, 0.5), 0.7);
}

TEST(LightPreview, DrawsACaptionAboveTheLight) {
  const Experiment experiment = scriptOf(step(0, kBright));
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 120);
  EXPECT_EQ(picture.width, 120);
  ASSERT_GT(picture.height, 90);
  for (int y = picture.height - 90; y < picture.height; ++y) {
    ASSERT_EQ(*picture.at(60, y), 204) << y;
  }
  bool caption = false;
  for (int x = 0; x < picture.width; ++x) caption = caption || *picture.at(x, 5) == 255;
  EXPECT_TRUE(caption);
}

constexpr const char* kTwoBands = R"(fileversion = 1
name = "bands"
duration_s = 100
[[robots]]
id = 7
x_cm = 90
y_cm = 45
theta_deg = 0
[programs.stand]
model = "stand"
[programs.turn]
model = "wheels"
left_cm_s = 1
right_cm_s = -1
[light_table]
bands = [{light = [0.0, 0.5], program = "stand"}, {light = [0.5, 1.0], program = "turn"}]
[[light.steps]]
at_s = 0
layers = [{kind = "uniform", intensity = 0.2},
  {kind = "half_plane", x_cm = 60, y_cm = 45, angle_deg = 0, intensity = 0.8}]
)";

using Rgb = std::array<int, 3>;

/// A pixel by its place in the arena [cm]; the picture ends with the arena.
Rgb at(const optics::RgbImage& picture, double x_cm, double y_cm) {
  const double scale = picture.width / 120.0;
  const std::uint8_t* pixel =
      picture.at(static_cast<int>(x_cm * scale),
                 std::min(picture.height - 1, static_cast<int>(picture.height - y_cm * scale)));
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(LightPreview, OutlinesTheRegionOfEachBandInTheColourOfItsProgram) {
  const Experiment experiment = parseExperiment(kTwoBands, "bands.toml");
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 480);
  constexpr Rgb kStand{0, 114, 178};  // the colours of the page
  constexpr Rgb kTurn{213, 94, 0};
  const Rgb left = at(picture, 59.8, 70);
  const Rgb right = at(picture, 60.2, 70);
  EXPECT_TRUE((left == kStand && right == kTurn) || (left == kTurn && right == kStand));
  EXPECT_NE(left, right);
  const auto isGrey = [](const Rgb& pixel) { return pixel[0] == pixel[1] && pixel[1] == pixel[2]; };
  EXPECT_TRUE(isGrey(at(picture, 30, 70)));
  EXPECT_TRUE(isGrey(at(picture, 110, 70)));
  // The legend names both: its first swatches have their colours.
  bool stand = false;
  bool turn = false;
  for (int y = 0; y < picture.height - 360; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* pixel = picture.at(x, y);
      const Rgb colour{pixel[0], pixel[1], pixel[2]};
      stand = stand || colour == kStand;
      turn = turn || colour == kTurn;
    }
  }
  EXPECT_TRUE(stand && turn);
}

TEST(LightPreview, NamesProgramsInGreyThatNoLightOfThePictureSelects) {
  std::string file = kTwoBands;
  file.replace(file.find("intensity = 0.8"), 15, "intensity = 0.2");
  const Experiment experiment = parseExperiment(file, "bands.toml");
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 480);
  for (std::size_t i = 0; i < picture.pixels.size(); i += 3) {
    const bool turn = picture.pixels[i] == 213 && picture.pixels[i + 1] == 94;
    ASSERT_FALSE(turn) << "the colour of the other program";
  }
}

TEST(LightPreview, DrawsRobotsWithHeadingAndId) {
  const Experiment experiment = parseExperiment(kTwoBands, "bands.toml");
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 480);
  constexpr Rgb kRobot{255, 255, 255};
  EXPECT_EQ(at(picture, 90 + 1.25 * 3.75, 45), kRobot) << "the heading, along x";
  EXPECT_NE(at(picture, 90 - 1.25 * 3.75, 45), kRobot);
  int white = 0;  // the 7
  for (double x = 88; x < 92; x += 0.25) {
    for (double y = 43; y < 47; y += 0.25) white += at(picture, x, y) == Rgb{255, 255, 255} ? 1 : 0;
  }
  EXPECT_GT(white, 8);
}

TEST(LightPreview, DrawsABarAsLongAsItSays) {
  const Experiment experiment = scriptOf(step(0, kDark));
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 480);
  // The longest row of white pixels is the bar: 20 cm of 120 cm.
  int longest = 0;
  for (int y = picture.height - 360; y < picture.height; ++y) {
    int length = 0;
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* pixel = picture.at(x, y);
      length = pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255 ? length + 1 : 0;
      longest = std::max(longest, length);
    }
  }
  EXPECT_EQ(longest, 80);
}

TEST(LightPreview, LimitsTheHeightOfTheTileOfANarrowArena) {
  const Experiment experiment = parseExperiment(R"(fileversion = 1
name = "tall"
duration_s = 100
program = "stand"
[arena]
width_cm = 10
height_cm = 3000
[reversal]
on = "never"
[[robots]]
id = 1
x_cm = 5
y_cm = 30
theta_deg = 90
[programs.stand]
model = "stand"
)" + step(0, kBright),
                                                "tall.toml");
  LightPreview dut(experiment, {});
  const optics::RgbImage picture = dut.picture(0, 0, 320);
  EXPECT_EQ(picture.width, 320);
  EXPECT_GT(picture.height, 640);
  EXPECT_LT(picture.height, 740) << "the arena and a head of some lines";
  const int middle = picture.height - 320;
  EXPECT_EQ(*picture.at(0, middle), 204);
  EXPECT_EQ(*picture.at(1, middle), 204);
  EXPECT_EQ(*picture.at(2, middle), 96) << "beside the arena";
  EXPECT_EQ(*picture.at(319, middle), 96);
}

TEST(MovieWriter, LeavesNothingOfAMovieThatIsNotFinished) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const TemporaryFolder folder;
  const std::filesystem::path former = folder.path() / "former.mp4";
  std::ofstream(former) << "former";
  for (const char* name : {"former.mp4", "new.mp4"}) {
    MovieWriter dut(folder.path() / name, 64, 48, 25);
    dut.write(optics::RgbImage(64, 48));
  }
  EXPECT_EQ(support::readFile(former), "former");
  std::filesystem::remove(former);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(MovieWriter, RefusesPicturesThatNoMovieTakes) {
  const TemporaryFolder folder;
  EXPECT_THROW(MovieWriter(folder.path() / "tall.mp4", 480, 144'000, 25), UserError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace lab::runner
