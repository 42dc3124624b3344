#include "light/field/layer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/light_samples.hpp"

namespace lab::light {
namespace {

using testing::HasSubstr;
using testing::Optional;
using testing::StartsWith;

Layer valid(LayerKind kind) {
  const std::vector<Layer> all = oneOfEachKind();
  return *std::ranges::find(all, kind, &Layer::kind);
}

TEST(Layer, OfEveryKindIsAccepted) {
  for (const Layer& layer : oneOfEachKind()) {
    EXPECT_EQ(validate(layer), std::nullopt) << "kind " << static_cast<int>(layer.kind);
  }
}

TEST(Layer, ByDefaultIsAcceptedAndDark) {
  EXPECT_EQ(validate(Layer{}), std::nullopt);
  EXPECT_EQ(evaluate(Field{{Layer{}}, {}, 1}, 0.5, 0.5), 0);
}

TEST(Layer, OfUnknownKindOrBlendIsRejected) {
  Layer kind;
  kind.kind = static_cast<LayerKind>(14);
  Layer blend;
  blend.blend = static_cast<Blend>(-1);

  EXPECT_THAT(validate(kind), Optional(std::string("kind = 14, allowed: 1 to 13")));
  EXPECT_THAT(validate(blend), Optional(std::string("blend = -1, allowed: 0 to 4")));
}

TEST(Layer, WithAValueNotFiniteIsRejectedByName) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity()};
  const std::pair<const char*, double Layer::*> fields[] = {{"x", &Layer::x},
                                                            {"y", &Layer::y},
                                                            {"angle", &Layer::angle},
                                                            {"size", &Layer::size},
                                                            {"inner", &Layer::inner},
                                                            {"softness", &Layer::softness},
                                                            {"intensity", &Layer::intensity},
                                                            {"intensity2", &Layer::intensity2},
                                                            {"phase", &Layer::phase}};
  for (const double value : bad) {
    for (const auto& [name, member] : fields) {
      for (Layer layer : oneOfEachKind()) {
        layer.*member = value;
        EXPECT_THAT(validate(layer), Optional(StartsWith(std::string(name) + " = ")))
            << "kind " << static_cast<int>(layer.kind);
      }
    }
  }
}

TEST(Layer, AValueJustBeyondABoundDoesNotLookLikeTheBound) {
  Layer layer = valid(LayerKind::kDisk);
  layer.intensity = 1.0000001;
  EXPECT_THAT(validate(layer), Optional(std::string("intensity = 1.0000001, allowed: 0 to 1")));
}

TEST(Layer, ReportsFoundAndAllowedValues) {
  Layer layer = valid(LayerKind::kDisk);
  layer.size = -0.1;
  EXPECT_THAT(validate(layer), Optional(std::string("size = -0.1 m, allowed: 0.001 to 30 m")));

  layer = valid(LayerKind::kDisk);
  layer.intensity = 1.5;
  EXPECT_THAT(validate(layer), Optional(std::string("intensity = 1.5, allowed: 0 to 1")));
}

TEST(Layer, RingNeedsItsInnerRadiusInsideItsOuter) {
  Layer layer = valid(LayerKind::kRing);
  layer.inner = layer.size;
  EXPECT_THAT(validate(layer),
              Optional(std::string("inner = 0.3 m, allowed: above 0 and below size = 0.3 m")));
  layer.inner = 0;
  EXPECT_THAT(validate(layer), Optional(StartsWith("inner = 0 m")));
}

TEST(Layer, RadialGradientMayStartAtItsCentreButNotAtItsEnd) {
  Layer layer = valid(LayerKind::kRadialGradient);
  layer.inner = 0;
  EXPECT_EQ(validate(layer), std::nullopt);
  layer.inner = 0.31;
  EXPECT_THAT(validate(layer), Optional(HasSubstr("below size = 0.3 m")));
}

TEST(Layer, StripesNeedAShareOfThePeriod) {
  Layer layer = valid(LayerKind::kStripes);
  layer.inner = 1;
  EXPECT_THAT(validate(layer), Optional(StartsWith("inner = 1, allowed: a share of the period")));
}

TEST(Layer, EdgesMustNotOverlap) {
  Layer disk = valid(LayerKind::kDisk);
  disk.softness = 0.601;
  Layer ring = valid(LayerKind::kRing);
  ring.softness = 0.101;
  Layer stripes = valid(LayerKind::kStripes);
  stripes.softness = 0.061;

  EXPECT_THAT(validate(disk), Optional(std::string("softness = 0.601 m, allowed: 0 to 0.6 m")));
  EXPECT_THAT(validate(ring), Optional(std::string("softness = 0.101 m, allowed: 0 to 0.1 m")));
  EXPECT_THAT(validate(stripes), Optional(std::string("softness = 0.061 m, allowed: 0 to 0.06 m")));
}

TEST(Layer, ImageNeedsADigestAndItsPixels) {
  Layer layer = valid(LayerKind::kImage);
  layer.pixels = nullptr;
  EXPECT_THAT(validate(layer), Optional(HasSubstr("an image that was loaded here")));
  layer = valid(LayerKind::kImage);
  layer.image = "picture.png";
  EXPECT_THAT(validate(layer), Optional(StartsWith("image = \"picture.png\"")));
  layer = valid(LayerKind::kImage);
  layer.image.assign(64, 'a');
  EXPECT_THAT(validate(layer), Optional(HasSubstr("that of its pixels")));
}

TEST(Layer, GridNeedsPixelsWithinTheLimit) {
  const auto with = [](int columns, int rows, std::size_t pixels) {
    Layer layer = valid(LayerKind::kGrid);
    layer.pixels = makeImage(columns, rows, std::vector<std::uint8_t>(pixels));
    return validate(layer);
  };
  EXPECT_EQ(with(160, 120, 19200), std::nullopt);
  EXPECT_THAT(with(161, 1, 161), Optional(std::string("columns = 161, allowed: 1 to 160")));
  EXPECT_THAT(with(1, 0, 0), Optional(std::string("rows = 0, allowed: 1 to 120")));
  EXPECT_THAT(with(4, 3, 11),
              Optional(std::string("grid = 11 pixels, allowed: columns x rows = 12")));
  Layer without = valid(LayerKind::kGrid);
  without.pixels = nullptr;
  EXPECT_THAT(validate(without), Optional(StartsWith("grid = no pixels")));
}

TEST(Layers, ReportTheIndexOfTheInvalidLayer) {
  std::vector<Layer> layers(3);
  layers[2].softness = 31;
  EXPECT_THAT(validate(layers),
              Optional(std::string("layers[2].softness = 31 m, allowed: 0 to 30 m")));
}

TEST(Layers, AreRejectedIfTooMany) {
  EXPECT_EQ(validate(std::vector<Layer>(kMostLayers)), std::nullopt);
  EXPECT_THAT(validate(std::vector<Layer>(kMostLayers + 1)),
              Optional(std::string("layers = 161 layers, allowed: at most 160")));
}

}  // namespace
}  // namespace lab::light
