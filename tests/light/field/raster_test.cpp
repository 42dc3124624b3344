#include "light/field/raster.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "light/field/image.hpp"
#include "tests/support/light_samples.hpp"

namespace lab::light {
namespace {

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

void expectPointwise(const Raster& raster, const Field& field) {
  const CompiledField compiled(field);
  for (int j = 0; j < raster.ny; ++j) {
    for (int i = 0; i < raster.nx; ++i) {
      const double x = (i + 0.5) * kWidth / raster.nx;
      const double y = (j + 0.5) * kHeight / raster.ny;
      ASSERT_NEAR(raster.at(i, j), compiled.evaluate(x, y), 1e-6) << "pixel " << i << ", " << j;
    }
  }
}

TEST(LightRaster, EqualsTheFieldAtThePixelCentresForEveryKindAndBlend) {
  for (const Layer& layer : oneOfEachKind()) {
    for (int blend = 0; blend <= 4; ++blend) {
      Field field{{Layer{.intensity = 0.3}, layer}, {}, 1};
      field.layers[1].blend = static_cast<Blend>(blend);
      expectPointwise(rasterise(field, kWidth, kHeight, 61, 43), field);
    }
  }
}

TEST(LightRaster, EqualsTheFieldInTheMiddleOfARamp) {
  const std::vector<Layer> all = oneOfEachKind();
  const Layer fade{.kind = LayerKind::kFade, .intensity = 0.6};
  const Field field{{all[3], all[6]}, {all[2], fade, all[7]}, 0.4};
  expectPointwise(rasterise(field, kWidth, kHeight, 61, 43), field);
}

TEST(LightRaster, HasItsFirstRowAtTheSmallestYAndItsPictureFlipped) {
  Layer layer{.kind = LayerKind::kLinearGradient, .y = 0.45, .angle = 1.5707963267948966};
  layer.size = 0.9;
  layer.intensity2 = 1;
  const Raster dut = rasterise(Field{{layer}, {}, 1}, kWidth, kHeight, 1, 3);
  EXPECT_NEAR(dut.at(0, 0), 1.0 / 6, 1e-6);
  EXPECT_NEAR(dut.at(0, 2), 5.0 / 6, 1e-6);
  EXPECT_EQ(toGrey(dut), (std::vector<std::uint8_t>{213, 128, 43}));
}

TEST(LightRaster, PngReadsBackToTheSameGrey) {
  const std::vector<Layer> all = oneOfEachKind();
  const Raster dut = rasterise(Field{{all[5], all[8]}, {}, 1}, kWidth, kHeight, 40, 30);
  const DecodedImage decoded = decodeImage(toPng(dut));
  ASSERT_TRUE(decoded.image) << decoded.error;
  EXPECT_EQ(decoded.image->columns, 40);
  EXPECT_EQ(decoded.image->rows, 30);
  EXPECT_EQ(decoded.image->grey, toGrey(dut));
}

TEST(LightRaster, NeedsPixelsAndASize) {
  EXPECT_THROW((void)rasterise(Field{}, kWidth, kHeight, 0, 3), std::invalid_argument);
  EXPECT_THROW((void)rasterise(Field{}, kWidth, 0, 3, 3), std::invalid_argument);
}

TEST(FramePainter, EqualsRasterise) {
  const std::vector<Layer> all = oneOfEachKind();
  const Field fields[] = {{{all[1]}, {}, 1},
                          {{all[2]}, {all[1]}, 0},
                          {{all[2]}, {all[1]}, 0.5},
                          {{all[2]}, {}, 1},
                          {{all[3], all[4]}, {all[2]}, 0.25},
                          {{}, {all[3], all[4]}, 0.75},
                          {{}, {}, 1}};
  FramePainter dut(kWidth, kHeight, 24, 18);
  for (const Field& field : fields) {
    const Raster& painted = dut.paint(field);
    const Raster expected = rasterise(field, kWidth, kHeight, 24, 18);
    ASSERT_EQ(painted.values.size(), expected.values.size());
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_NEAR(painted.values[i], expected.values[i], 1e-6);
    }
  }
}

TEST(LightRaster, LimitsBothSidesOfAPictureAndKeepsItsProportions) {
  const auto expectSize = [](double width, double height, int nx, int ny) {
    const PictureSize size = pictureSize(width, height, 320);
    EXPECT_EQ(size.nx, nx) << width << " x " << height;
    EXPECT_EQ(size.ny, ny) << width << " x " << height;
  };
  expectSize(1.2, 0.9, 320, 240);
  expectSize(1, 2, 320, 640);
  expectSize(1, 4, 160, 640);
  expectSize(0.1, 30, 2, 640);
  expectSize(30, 0.1, 320, 1);
}

}  // namespace
}  // namespace lab::light
