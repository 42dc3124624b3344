#include "runner/commands/layer_arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <optional>

#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/image_file.hpp"
#include "light/field/image.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

using light::LayerKind;

std::vector<light::DrivenLayer> layersOf(const std::vector<std::string>& texts,
                                         const std::filesystem::path& directory = ".",
                                         const light::ImageStore& known = {}) {
  return parseLayers(texts, placeholderExperiment(), known, directory);
}

std::filesystem::path writePicture(const std::filesystem::path& path) {
  const std::array<std::uint8_t, 4> grey = {0, 255, 128, 64};
  replaceFile(path, light::encodePng(2, 2, grey));
  return path;
}

TEST(LayerArguments, ReadNumbersAsUniformLight) {
  const auto dut = layersOf({"0.25"});
  ASSERT_EQ(dut.size(), 1U);
  EXPECT_EQ(dut[0].layer, light::Layer{.intensity = 0.25});
}

TEST(LayerArguments, AcceptEveryKeyOfAFile) {
  const auto dut =
      layersOf({R"({kind = "wave", period_cm = 40, speed_cm_s = 2, intensity = 1})",
                R"({kind = "disk", radius_cm = 4, follow = "robots", intensity = 1})",
                R"({kind = "uniform", program = "none", waveform = "sine", period_s = 2})"});
  ASSERT_EQ(dut.size(), 3U);
  EXPECT_EQ(dut[0].layer.kind, LayerKind::kWave);
  EXPECT_GT(dut[0].drive.phase_rate, 0);
  EXPECT_EQ(dut[1].drive.follow, light::Follow::kRobots);
  EXPECT_EQ(dut[2].layer.intensity, 0.5);
  EXPECT_EQ(dut[2].drive.waveform, light::Waveform::kSine);
}

TEST(LayerArguments, ConvertAnUnknownPictureToAGrid) {
  const TemporaryFolder folder;
  writePicture(folder / "a.png");
  const std::string layer =
      R"({kind = "image", file = "a.png", width_cm = 30, height_cm = 30, intensity = 1})";
  const auto dut = layersOf({layer}, folder / "");
  ASSERT_EQ(dut.size(), 1U);
  EXPECT_EQ(dut[0].layer.kind, LayerKind::kGrid);
  EXPECT_EQ(dut[0].layer.image, "");
  ASSERT_TRUE(dut[0].layer.pixels);
  EXPECT_THAT(dut[0].layer.pixels->grey, testing::ElementsAre(0, 255, 128, 64));
  EXPECT_EQ(light::validate(dut[0].layer), std::nullopt);

  const auto image = loadImage(folder / "a.png").image;
  const auto known = layersOf({layer}, folder / "", {{image->sha256, image}});
  EXPECT_EQ(known[0].layer.kind, LayerKind::kImage);
  EXPECT_EQ(known[0].layer.image, image->sha256);
}

TEST(LayerArguments, RefuseASequenceOfUnknownPictures) {
  const TemporaryFolder folder;
  writePicture(folder / "a.png");
  EXPECT_THROW(
      (void)layersOf(
          {R"({kind = "image", files = ["a.png"], width_cm = 30, height_cm = 30, intensity = 1})"},
          folder / ""),
      UserError);
}

TEST(LayerArguments, RefuseWhatAFileWouldRefuse) {
  EXPECT_THROW((void)layersOf({R"({kind = "disk", intensity = 1})"}), UserError);
  EXPECT_THROW((void)layersOf({"2"}), UserError);
  EXPECT_THROW((void)layersOf({R"({kind = "uniform", program = "bp"})"}), UserError);
}

TEST(LayerArguments, ErrorsNameTheArgumentAndNoFile) {
  const auto refusal = [](const std::vector<std::string>& typed) -> std::string {
    try {
      (void)layersOf(typed);
    } catch (const UserError& error) {
      return error.what();
    }
    return {};
  };
  using testing::AllOf;
  using testing::HasSubstr;
  using testing::Not;
  using testing::StartsWith;
  const auto of_no_file =
      AllOf(Not(HasSubstr("lab light:")), Not(HasSubstr("light.steps")), Not(HasSubstr("\n")));
  EXPECT_THAT(refusal({"uniform"}), AllOf(StartsWith("light 'uniform': found no "),
                                          HasSubstr("expected an intensity"), of_no_file));
  EXPECT_THAT(refusal({"2"}), AllOf(StartsWith("light '2': intensity: found 2"), of_no_file));
  const std::string wrong = R"({kind = "uniform", intensity = 1, brightness = 1})";
  EXPECT_THAT(refusal({"0.5", wrong}),
              AllOf(StartsWith("light '" + wrong + "': brightness: "), of_no_file));
}

}  // namespace
}  // namespace lab::runner
