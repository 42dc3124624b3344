// A culled field must show the same light in the disk, and batch evaluation must equal single
// evaluation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/math/random.hpp"
#include "light/field/field.hpp"
#include "light/field/image.hpp"

namespace lab::light {
namespace {

constexpr double kLastBits = 1e-14;

std::shared_ptr<const Image> picture(Random& random) {
  auto image = std::make_shared<Image>();
  image->columns = 24;
  image->rows = 18;
  // Uniform patches, so that some discs contain a single value.
  for (int i = 0; i < image->columns * image->rows; ++i) {
    const bool patch = i % image->columns < 12;
    image->grey.push_back(patch ? 200 : static_cast<std::uint8_t>(random.next() % 256));
  }
  return image;
}

Layer randomLayer(Random& random) {
  static constexpr LayerKind kKinds[] = {
      LayerKind::kUniform, LayerKind::kHalfPlane,      LayerKind::kDisk,
      LayerKind::kRing,    LayerKind::kLinearGradient, LayerKind::kRadialGradient,
      LayerKind::kStripes, LayerKind::kChecker,        LayerKind::kImage,
      LayerKind::kFade,    LayerKind::kNoise,          LayerKind::kWave,
      LayerKind::kGrid};
  Layer layer;
  layer.kind = kKinds[random.next() % std::size(kKinds)];
  layer.blend = static_cast<Blend>(random.next() % 5);
  layer.x = 1.2 * random.uniform();
  layer.y = 0.9 * random.uniform();
  layer.angle = 6 * random.uniform();
  layer.size = 0.05 + 0.6 * random.uniform();
  const bool share = layer.kind == LayerKind::kStripes;
  layer.inner = share ? 0.2 + 0.6 * random.uniform() : layer.size * (0.2 + 0.6 * random.uniform());
  layer.softness = random.next() % 2 == 0 ? 0 : 0.01 * random.uniform();
  layer.intensity = random.next() % 4 == 0 ? 1 : random.uniform();
  layer.intensity2 = random.next() % 4 == 0 ? 0 : random.uniform();
  layer.seed = random.next();
  layer.phase = 9 * random.uniform();
  if (layer.kind == LayerKind::kImage || layer.kind == LayerKind::kGrid) {
    layer.pixels = picture(random);
  }
  return layer;
}

Field randomField(Random& random) {
  Field field;
  const auto fill = [&](std::vector<Layer>& layers) {
    for (std::uint64_t i = 0; i < 1 + random.next() % 8; ++i) layers.push_back(randomLayer(random));
  };
  fill(field.layers);
  if (random.next() % 3 == 0) {
    fill(field.previous);
    field.mix = random.uniform();
  }
  return field;
}

TEST(Culling, FewerLayersShowTheSameLightInsideTheDisc) {
  Random random(7);
  int uniform = 0;
  for (int i = 0; i < 4000; ++i) {
    const CompiledField all(randomField(random));
    const Disk disk{1.2 * random.uniform(), 0.9 * random.uniform(),
                    0.1 * random.uniform() * random.uniform()};
    const CompiledField here = all.within(disk);
    uniform += here.isUniform() && !all.isUniform() ? 1 : 0;
    for (int j = 0; j < 40; ++j) {
      const double angle = 6.2832 * random.uniform();
      const double r = disk.radius * (j % 2 == 0 ? 1 : random.uniform());
      const double x = disk.x + r * std::cos(angle);
      const double y = disk.y + r * std::sin(angle);
      ASSERT_NEAR(here.evaluate(x, y), all.evaluate(x, y), kLastBits) << "field " << i;
    }
  }
  EXPECT_GT(uniform, 400);  // otherwise nothing was culled
}

TEST(Culling, BatchEvaluationGivesTheSameNumbers) {
  Random random(8);
  std::vector<double> x(200);
  std::vector<double> y(200);
  std::vector<double> light(200);
  for (int i = 0; i < 500; ++i) {
    const CompiledField field(randomField(random));
    for (std::size_t j = 0; j < x.size(); ++j) {
      x[j] = 1.4 * random.uniform() - 0.1;
      y[j] = 1.1 * random.uniform() - 0.1;
    }
    field.evaluateAt(x.data(), y.data(), x.size(), light.data());
    for (std::size_t j = 0; j < x.size(); ++j) {
      ASSERT_EQ(light[j], field.evaluate(x[j], y[j])) << "field " << i;
    }
  }
}

TEST(Culling, ComparesCulledFields) {
  Layer spot{.kind = LayerKind::kDisk, .x = 0.3, .y = 0.3, .size = 0.05, .intensity = 1};
  const Layer ground{.intensity = 0.2};
  const CompiledField before(Field{{ground, spot}, {}, 1});
  spot.x = 0.31;
  const CompiledField after(Field{{ground, spot}, {}, 1});
  EXPECT_FALSE(before == after);
  EXPECT_FALSE(before.within({0.35, 0.3, 0.02}) == after.within({0.35, 0.3, 0.02}));
  EXPECT_TRUE(before.within({0.6, 0.3, 0.1}) == after.within({0.6, 0.3, 0.1}));
  EXPECT_TRUE(before.within({0.305, 0.3, 0.02}) == after.within({0.305, 0.3, 0.02}));
  EXPECT_EQ(after.within({0.305, 0.3, 0.02}).evaluate(0.3, 0.3), 1);
}

TEST(Culling, KeepsAHardEdgeInPlace) {
  const CompiledField all(
      Field{{Layer{.kind = LayerKind::kHalfPlane, .x = 0.5, .y = 0.5, .intensity = 1}}, {}, 1});
  for (const double away : {-1e-3, -1e-8, 0.0, 1e-8, 1e-3}) {
    const CompiledField here = all.within({0.5 + away, 0.5, 1e-8});
    for (const double x : {away - 1e-8, away, away + 1e-8}) {
      ASSERT_EQ(here.evaluate(0.5 + x, 0.5), all.evaluate(0.5 + x, 0.5)) << away << " " << x;
    }
  }
}

}  // namespace
}  // namespace lab::light
