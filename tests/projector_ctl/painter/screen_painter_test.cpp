#include "projector_ctl/painter/screen_painter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "light/field/raster.hpp"
#include "light/optics/simulated_projector.hpp"

namespace lab::projector::screen_painter_test {
namespace {

using light::Blend;
using light::Field;
using light::Layer;
using light::LayerKind;

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;
constexpr int kColumns = 500;  // not a whole number of tiles
constexpr int kRows = 270;

optics::ProjectorModel nominal() { return {kWidth, kHeight, kColumns, kRows}; }

optics::ProjectorModel keystone() {
  return optics::simulatedProjector(kWidth, kHeight, kColumns, kRows,
                                    {.keystone = 0.15, .barrel = 0.08, .offset_x = 0.03});
}

/// Hard edges, soft ones, and a spot that depends on `time`.
Field fieldAt(double time) {
  Field field;
  field.layers = {
      Layer{.intensity = 0.3},
      Layer{.kind = LayerKind::kHalfPlane, .x = 0.7, .y = 0.4, .angle = 0.4, .intensity = 0.8},
      Layer{.kind = LayerKind::kStripes,
            .blend = Blend::kMultiply,
            .x = 0.2,
            .y = 0.2,
            .angle = 0.1,
            .size = 0.3,
            .inner = 0.4,
            .intensity = 1,
            .intensity2 = 0.7},
      Layer{.kind = LayerKind::kRing,
            .x = 0.5,
            .y = 0.5,
            .size = 0.2,
            .inner = 0.15,
            .softness = 0.01,
            .intensity = 1},
      Layer{.kind = LayerKind::kDisk,
            .x = 0.2 + 0.3 * time,
            .y = 0.3 + 0.2 * time,
            .size = 0.06,
            .intensity = 1}};
  return field;
}

/// Largest difference between a pixel and the light field at its centre.
int worst(const ScreenPainter& painter, const Field& field, const optics::ProjectorModel& model) {
  const light::CompiledField light(field);
  int most = 0;
  for (int j = 0; j < model.rows(); ++j) {
    for (int i = 0; i < model.columns(); ++i) {
      const auto place = model.placeOf({static_cast<double>(i), static_cast<double>(j)});
      const double wanted = place ? light.evaluate(place->x, place->y) : 0;
      const auto level = static_cast<int>(std::lround(255 * static_cast<float>(wanted)));
      most = std::max(most, std::abs(level - int{painter.picture().row(j)[i]}));
    }
  }
  return most;
}

TEST(ScreenPainter, EqualsTheRasterOfTheLightFieldWithoutCalibration) {
  ScreenPainter painter(nominal());
  painter.paint(fieldAt(0));
  const auto raster = light::toGrey(light::rasterise(fieldAt(0), kWidth, kHeight, kColumns, kRows));
  int most = 0;
  for (std::size_t i = 0; i < raster.size(); ++i) {
    most = std::max(most, std::abs(int{raster[i]} - int{painter.picture().data[i]}));
  }
  EXPECT_LE(most, 1);
  EXPECT_LE(worst(painter, fieldAt(0), nominal()), 1);
}

TEST(ScreenPainter, UsesTheCalibrationOfTheProjector) {
  ScreenPainter painter(keystone());
  painter.paint(fieldAt(0.5));
  EXPECT_LE(worst(painter, fieldAt(0.5), keystone()), 1);
}

TEST(ScreenPainter, MovingLayersLeaveNoTraces) {
  ScreenPainter painter(keystone());
  for (int frame = 0; frame < 12; ++frame) {
    painter.paint(fieldAt(0.1 * frame));
    ASSERT_LE(worst(painter, fieldAt(0.1 * frame), keystone()), 1) << "frame " << frame;
  }
  Field fading = fieldAt(0);
  fading.previous = fieldAt(1).layers;
  for (const double mix : {0.0, 0.4, 0.9, 1.0}) {
    fading.mix = mix;
    painter.paint(fading);
    ASSERT_LE(worst(painter, fading, keystone()), 1) << "mix " << mix;
  }
}

TEST(ScreenPainter, PaintsOnlyWhatChanges) {
  ScreenPainter painter(nominal());
  int pixels = 0;
  for (const Box& box : painter.paint(fieldAt(0))) pixels += box.width * box.height;
  EXPECT_EQ(pixels, kColumns * kRows);
  EXPECT_TRUE(painter.paint(fieldAt(0)).empty());
  pixels = 0;
  for (const Box& box : painter.paint(fieldAt(0.01))) pixels += box.width * box.height;
  EXPECT_GT(pixels, 0);
  EXPECT_LT(pixels, kColumns * kRows / 10);  // only one spot changes
  const Box box{40, 40, 10, 10};
  for (int y = box.y; y < box.y + box.height; ++y) {
    std::fill_n(painter.canvas().row(y) + box.x, box.width, std::uint8_t{7});
  }
  painter.forget(box);
  EXPECT_FALSE(painter.paint(fieldAt(0.01)).empty());
  EXPECT_LE(worst(painter, fieldAt(0.01), nominal()), 1);
}

TEST(ScreenPainter, AToneMayDependOnThePixel) {
  class Vignette final : public Tone {
   public:
    [[nodiscard]] bool isSameEverywhere() const override { return false; }
    void apply(const double* intensity, int x, int y, std::size_t count,
               std::uint8_t* out) const override {
      for (std::size_t i = 0; i < count; ++i) {
        out[i] =
            static_cast<std::uint8_t>(100 * intensity[i] + (x + static_cast<int>(i) + y) % 100);
      }
    }
  };
  ScreenPainter painter(nominal(), std::make_shared<Vignette>());
  painter.paint({{Layer{.intensity = 1}}, {}, 1});
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      ASSERT_EQ(painter.picture().row(j)[i], 100 + (i + j) % 100) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace lab::projector::screen_painter_test
