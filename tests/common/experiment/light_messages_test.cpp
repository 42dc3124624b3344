#include "common/experiment/light_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>

#include "common/bus/bus.hpp"
#include "common/files/atomic_file.hpp"
#include "tests/support/light_samples.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

TEST(LightMessages, ConvertLayersOfEveryKindThereAndBack) {
  const std::vector<light::Layer> layers = light::oneOfEachKind();
  light::ImageStore images;
  for (const light::Layer& layer : layers) {
    if (!layer.image.empty()) images[layer.image] = layer.pixels;
  }
  std::vector<light::Layer> out = toLayers(toMessages(layers), images);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (layers[i].kind != light::LayerKind::kGrid) continue;
    // The pixels of a grid are part of the message, so they are equal but another object.
    ASSERT_NE(out[i].pixels, nullptr);
    EXPECT_EQ(out[i].pixels->columns, layers[i].pixels->columns);
    EXPECT_EQ(out[i].pixels->rows, layers[i].pixels->rows);
    EXPECT_EQ(out[i].pixels->grey, layers[i].pixels->grey);
    out[i].pixels = layers[i].pixels;
  }
  EXPECT_EQ(out, layers);
}

TEST(LightMessages, LeaveAnUnknownImageWithoutPixels) {
  light::Layer layer;
  layer.kind = light::LayerKind::kImage;
  layer.image = std::string(64, 'a');
  const std::vector<light::Layer> out = toLayers(toMessages({layer}));
  EXPECT_EQ(out.back().image, layer.image);
  EXPECT_EQ(out.back().pixels, nullptr);
}

TEST(LightMessages, GiveTheFieldDuringARamp) {
  const light::Field field{
      {light::Layer{.intensity = 0.9}}, {light::Layer{.intensity = 0.1}}, 0.25};
  light_status_t status{};
  status.mix = field.mix;
  status.layers = toMessages(field.layers);
  status.previous = toMessages(field.previous);
  status.num_layers = status.num_previous = 1;
  light_status_t received{};
  ASSERT_TRUE(decode(encode(status), received));
  EXPECT_EQ(toField(received), field);
}

TEST(LightMessages, KeepTheLargestStatusBelowTheSizeLimit) {
  light_status_t status{};
  light::Layer layer;
  layer.image.assign(64, 'a');
  status.layers = status.previous = toMessages(std::vector(light::kMostLayers, layer));
  status.num_layers = status.num_previous = static_cast<std::int32_t>(light::kMostLayers);
  EXPECT_LT(encode(status).size(), 60'000U);
}

TEST(LightMessages, WithAnUnknownKindAreRefusedByValidate) {
  light_layer_t message{};
  message.kind = 42;
  EXPECT_EQ(light::validate(toLayers({message})), "layers[0].kind = 42, allowed: 1 to 13");
}

TEST(ExperimentImages, AreLoadedOnceAndFoundByPathAndDigest) {
  const TemporaryFolder directory;
  const std::string name = "light_messages_test.png";
  const std::vector<std::uint8_t> png = light::encodePng(1, 1, std::vector<std::uint8_t>{9});
  replaceFile(directory / name, png);
  Experiment experiment;
  LayerSpec layer;
  layer.image = name;
  experiment.light.steps.resize(2);
  experiment.light.steps[0].layers = {LayerSpec{}, layer};
  experiment.light.steps[1].layers = {layer};

  const ExperimentImages dut = loadImages(experiment, directory.path());

  ASSERT_EQ(dut.store.size(), 1U);
  EXPECT_EQ(dut.digests.at(name), light::sha256(png));
  EXPECT_EQ(dut.store.at(light::sha256(png))->grey, std::vector<std::uint8_t>{9});
}

TEST(ExperimentImages, ThatAreMissingAreNamed) {
  Experiment experiment;
  LayerSpec layer;
  layer.image = "no_such_picture.png";
  experiment.light.steps.resize(1);
  experiment.light.steps[0].layers = {layer};
  EXPECT_THROW((void)loadImages(experiment, testing::TempDir()), std::runtime_error);
}

TEST(LightMessages, ParseTheRefusalOfOneCommandOnly) {
  const std::string said = formatRefusal("lab_light", 7, "layers[0].stale = nan s");
  EXPECT_EQ(said, "LIGHT_COMMAND 7 of lab_light: layers[0].stale = nan s");
  EXPECT_EQ(lab::parseRefusal("lab_light", 7, said), "layers[0].stale = nan s");
  EXPECT_EQ(lab::parseRefusal("lab_light", 8, said), "");
  EXPECT_EQ(lab::parseRefusal("lab", 7, said), "");
  EXPECT_EQ(lab::parseRefusal("lab_light", 7, ""), "");
}

}  // namespace
}  // namespace lab
