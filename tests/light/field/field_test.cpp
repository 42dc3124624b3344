#include "light/field/field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/light_samples.hpp"

namespace lab::light {
namespace {

constexpr double kExact = 1e-12;
constexpr double kQuarterTurn = std::numbers::pi / 2;

Field fieldOf(std::vector<Layer> layers) { return {std::move(layers), {}, 1}; }

Field bright(Layer layer) {
  layer.intensity = 1;
  return fieldOf({layer});
}

Layer uniform(double intensity, Blend blend = Blend::kOver) {
  return {.blend = blend, .intensity = intensity};
}

Layer disk(double x, double y, double radius, double intensity, Blend blend = Blend::kOver) {
  Layer layer{.kind = LayerKind::kDisk, .blend = blend, .x = x, .y = y, .size = radius};
  layer.intensity = intensity;
  return layer;
}

TEST(LightField, WithoutLayersIsDark) { EXPECT_EQ(evaluate(Field{}, 0.3, 0.3), 0); }

TEST(LightField, UniformHasItsIntensityEverywhere) {
  const Field dut = fieldOf({uniform(0.37)});
  EXPECT_EQ(evaluate(dut, 0, 0), 0.37);
  EXPECT_EQ(evaluate(dut, 1.2, 0.9), 0.37);
}

TEST(LightField, HalfPlaneLightsTheSideOfItsAngle) {
  const Field to_the_right = bright({.kind = LayerKind::kHalfPlane, .x = 0.6, .y = 0.45});
  EXPECT_EQ(evaluate(to_the_right, 0.61, 0.1), 1);
  EXPECT_EQ(evaluate(to_the_right, 0.6, 0.8), 1);
  EXPECT_EQ(evaluate(to_the_right, 0.59, 0.1), 0);

  const Field up =
      bright({.kind = LayerKind::kHalfPlane, .x = 0.6, .y = 0.45, .angle = kQuarterTurn});
  EXPECT_EQ(evaluate(up, 0.1, 0.46), 1);
  EXPECT_EQ(evaluate(up, 0.1, 0.44), 0);
}

TEST(LightField, DiskEndsAtItsRadius) {
  const Field dut = fieldOf({disk(0.5, 0.5, 0.25, 0.8)});
  EXPECT_EQ(evaluate(dut, 0.5, 0.5), 0.8);
  EXPECT_EQ(evaluate(dut, 0.65, 0.699), 0.8);  // 3-4-5 triangle, just inside 0.25
  EXPECT_EQ(evaluate(dut, 0.65, 0.701), 0);
  EXPECT_EQ(evaluate(dut, 0.75, 0.5), 0.8);  // on the line
}

TEST(LightField, RingLiesBetweenItsRadii) {
  const Field dut = bright({.kind = LayerKind::kRing, .size = 0.3, .inner = 0.2});
  EXPECT_EQ(evaluate(dut, 0, 0), 0);
  EXPECT_EQ(evaluate(dut, 0.199, 0), 0);
  EXPECT_EQ(evaluate(dut, 0, 0.201), 1);
  EXPECT_EQ(evaluate(dut, -0.299, 0), 1);
  EXPECT_EQ(evaluate(dut, 0, -0.301), 0);
}

TEST(LightField, LinearGradientRunsOverItsLengthAndStaysBeyond) {
  Layer layer{.kind = LayerKind::kLinearGradient, .x = 0.6, .y = 0.45, .size = 0.4};
  layer.intensity = 0.2;
  layer.intensity2 = 0.6;
  const Field dut = fieldOf({layer});
  EXPECT_NEAR(evaluate(dut, 0.6, 0.1), 0.4, kExact);
  EXPECT_NEAR(evaluate(dut, 0.5, 0.9), 0.3, kExact);
  EXPECT_NEAR(evaluate(dut, 0.8, 0.2), 0.6, kExact);
  EXPECT_EQ(evaluate(dut, 1.1, 0.2), 0.6);
  EXPECT_EQ(evaluate(dut, 0.1, 0.2), 0.2);
}

TEST(LightField, RadialGradientRunsFromItsInnerRadiusToItsOuter) {
  Layer layer{.kind = LayerKind::kRadialGradient, .x = 0.5, .y = 0.5, .size = 0.5, .inner = 0.1};
  layer.intensity = 1;
  layer.intensity2 = 0.2;
  const Field dut = fieldOf({layer});
  EXPECT_EQ(evaluate(dut, 0.55, 0.5), 1);
  EXPECT_NEAR(evaluate(dut, 0.5, 0.8), 0.6, kExact);
  EXPECT_NEAR(evaluate(dut, 0.0, 0.5), 0.2, kExact);
  EXPECT_NEAR(evaluate(dut, 0.5, 1.4), 0.2, kExact);
}

TEST(LightField, StripesFillTheirShareOfEachPeriod) {
  Layer layer{.kind = LayerKind::kStripes, .x = 0.1, .y = 0.3, .size = 0.2, .inner = 0.25};
  layer.intensity = 0.9;
  layer.intensity2 = 0.3;
  const Field dut = fieldOf({layer});
  for (const double centre : {0.1, 0.3, -0.1, 0.9}) {  // half a stripe is 0.025
    EXPECT_NEAR(evaluate(dut, centre, 0.77), 0.9, kExact);
    EXPECT_NEAR(evaluate(dut, centre + 0.024, 0.5), 0.9, kExact);
    EXPECT_NEAR(evaluate(dut, centre - 0.024, 0.5), 0.9, kExact);
    EXPECT_NEAR(evaluate(dut, centre + 0.026, 0.5), 0.3, kExact);
    EXPECT_NEAR(evaluate(dut, centre + 0.1, 0.5), 0.3, kExact);
  }
}

TEST(LightField, CheckerAlternatesFromTheSquareAtItsCentre) {
  Layer layer{.kind = LayerKind::kChecker, .x = 0.6, .y = 0.4, .size = 0.2};
  layer.intensity = 0.9;
  layer.intensity2 = 0.3;
  const Field dut = fieldOf({layer});
  EXPECT_NEAR(evaluate(dut, 0.6, 0.4), 0.9, kExact);
  EXPECT_NEAR(evaluate(dut, 0.69, 0.49), 0.9, kExact);
  EXPECT_NEAR(evaluate(dut, 0.71, 0.49), 0.3, kExact);
  EXPECT_NEAR(evaluate(dut, 0.69, 0.51), 0.3, kExact);
  EXPECT_NEAR(evaluate(dut, 0.8, 0.6), 0.9, kExact);
  EXPECT_NEAR(evaluate(dut, 0.4, 0.4), 0.3, kExact);
  EXPECT_NEAR(evaluate(dut, 0.2, 0.4), 0.9, kExact);
}

TEST(LightField, ImageIsBilinearBetweenPixelCentresWithItsTopUp) {
  const auto image = makeImage(2, 2, {0, 255, 255, 255});  // dark at the top left
  Layer layer{.kind = LayerKind::kImage, .x = 0.6, .y = 0.45, .size = 0.4, .inner = 0.2};
  layer.intensity = 0.9;
  layer.intensity2 = 0.1;
  layer.image = image->sha256;
  layer.pixels = image;
  const Field dut = fieldOf({uniform(0.5), layer});
  EXPECT_NEAR(evaluate(dut, 0.5, 0.5), 0.1, kExact);   // its centre
  EXPECT_NEAR(evaluate(dut, 0.7, 0.5), 0.9, kExact);   // right of it
  EXPECT_NEAR(evaluate(dut, 0.5, 0.4), 0.9, kExact);   // below it
  EXPECT_NEAR(evaluate(dut, 0.6, 0.5), 0.5, kExact);   // between dark and bright
  EXPECT_NEAR(evaluate(dut, 0.6, 0.45), 0.7, kExact);  // in the middle: three bright, one dark
  EXPECT_NEAR(evaluate(dut, 0.41, 0.54), 0.1, kExact);
  EXPECT_NEAR(evaluate(dut, 0.39, 0.54), 0.5, kExact);  // beside the image
}

TEST(LightField, ImageWithoutItsPixelsIsBlack) {
  Layer layer{.kind = LayerKind::kImage, .x = 0.5, .y = 0.5, .size = 0.2, .inner = 0.2};
  layer.intensity = 1;
  EXPECT_EQ(evaluate(fieldOf({uniform(0.5), layer}), 0.5, 0.5), 0);
}

TEST(LightField, BlendsFollowTheirFormulas) {
  const auto blended = [](Blend blend) {
    return evaluate(fieldOf({uniform(0.4), uniform(0.5, blend)}), 0, 0);
  };
  EXPECT_NEAR(blended(Blend::kOver), 0.5, kExact);
  EXPECT_NEAR(blended(Blend::kAdd), 0.9, kExact);
  EXPECT_NEAR(blended(Blend::kMultiply), 0.2, kExact);
  EXPECT_NEAR(blended(Blend::kMax), 0.5, kExact);
  EXPECT_NEAR(blended(Blend::kMin), 0.4, kExact);
}

TEST(LightField, LayersChangeNothingOutsideTheirCover) {
  for (const Blend blend :
       {Blend::kOver, Blend::kAdd, Blend::kMultiply, Blend::kMax, Blend::kMin}) {
    const Field dut = fieldOf({uniform(0.4), disk(0.5, 0.5, 0.1, 0.2, blend)});
    EXPECT_NEAR(evaluate(dut, 0.7, 0.5), 0.4, kExact);
  }
}

TEST(LightField, ClampsTheResultButNotBetweenLayers) {
  const Layer light = uniform(0.8, Blend::kAdd);
  EXPECT_EQ(evaluate(fieldOf({light, light}), 0, 0), 1);
  EXPECT_NEAR(evaluate(fieldOf({light, light, uniform(0.5, Blend::kMultiply)}), 0, 0), 0.8, kExact);
}

TEST(LightField, RadialGradientMultipliedIsARoundMask) {
  Layer mask{.kind = LayerKind::kRadialGradient, .blend = Blend::kMultiply, .x = 0.5, .y = 0.5};
  mask.size = 0.201;
  mask.inner = 0.2;
  mask.intensity = 1;
  const Field dut = fieldOf({uniform(0.7), mask});
  EXPECT_NEAR(evaluate(dut, 0.65, 0.5), 0.7, kExact);
  EXPECT_NEAR(evaluate(dut, 0.75, 0.5), 0, kExact);
}

TEST(LightField, SoftEdgeIsHalfOnTheLineAndSymmetricAboutIt) {
  Layer layer{.kind = LayerKind::kHalfPlane, .x = 0.6, .softness = 0.1};
  layer.intensity = 1;
  const CompiledField dut(fieldOf({layer}));
  EXPECT_NEAR(dut.evaluate(0.6, 0), 0.5, kExact);
  EXPECT_NEAR(dut.evaluate(0.625, 0), 27.0 / 32, kExact);  // 3t^2 - 2t^3 at t = 3/4
  EXPECT_NEAR(dut.evaluate(0.65, 0), 1, kExact);
  EXPECT_NEAR(dut.evaluate(0.55, 0), 0, kExact);
  double last = 0;
  for (double d = 0; d < 0.07; d += 0.003) {
    EXPECT_NEAR(dut.evaluate(0.6 + d, 0) + dut.evaluate(0.6 - d, 0), 1, kExact);
    EXPECT_GE(dut.evaluate(0.6 + d, 0), last);
    last = dut.evaluate(0.6 + d, 0);
  }
}

TEST(LightField, SoftEdgeOfEveryShapeIsHalfOnItsLine) {
  Layer base{.size = 0.2, .inner = 0.1, .softness = 0.04};
  base.intensity = 1;
  const auto at = [&](LayerKind kind, double x, double y) {
    Layer layer = base;
    layer.kind = kind;
    if (kind == LayerKind::kStripes) layer.inner = 0.5;
    return evaluate(fieldOf({layer}), x, y);
  };
  EXPECT_NEAR(at(LayerKind::kDisk, 0, 0.2), 0.5, kExact);
  EXPECT_NEAR(at(LayerKind::kRing, 0, 0.2), 0.5, kExact);
  EXPECT_NEAR(at(LayerKind::kRing, -0.1, 0), 0.5, kExact);
  EXPECT_NEAR(at(LayerKind::kStripes, 0.05, 0.7), 0.5, kExact);
  EXPECT_NEAR(at(LayerKind::kChecker, 0.1, 0.03), 0.5, kExact);
  EXPECT_NEAR(at(LayerKind::kChecker, 0.1, 0.1), 0.5, kExact);
}

TEST(LightField, WaveHasItsCrestWhereItsPhaseSays) {
  Layer layer{.kind = LayerKind::kWave, .x = 0.6, .y = 0.45, .size = 0.2};
  layer.intensity = 0.9;
  layer.intensity2 = 0.1;
  const auto at = [&](double phase, double x) {
    layer.phase = phase;
    return evaluate(fieldOf({layer}), x, 0.1);
  };
  EXPECT_NEAR(at(0, 0.6), 0.9, kExact);
  EXPECT_NEAR(at(0, 0.7), 0.1, kExact);
  EXPECT_NEAR(at(0, 0.65), 0.5, kExact);
  // A quarter of a turn later the crest is a quarter of a period further.
  EXPECT_NEAR(at(kQuarterTurn, 0.65), 0.9, kExact);
  EXPECT_NEAR(at(kQuarterTurn + 4e6 * kQuarterTurn, 0.65), 0.9, 1e-6);
}

TEST(LightField, NoiseRunsBetweenItsIntensities) {
  Layer layer{.kind = LayerKind::kNoise, .size = 0.05};
  layer.intensity = 0.7;
  layer.intensity2 = 0.2;
  const CompiledField dut(fieldOf({layer}));
  double least = 1;
  double most = 0;
  for (double x = 0; x < 4; x += 0.01) {
    least = std::min(least, dut.evaluate(x, 0.3));
    most = std::max(most, dut.evaluate(x, 0.3));
  }
  EXPECT_GE(least, 0.2);
  EXPECT_LT(least, 0.22);
  EXPECT_LE(most, 0.7);
  EXPECT_GT(most, 0.68);
}

TEST(LightField, GridIsAnImageOfItsOwnPixels) {
  const auto pixels = makeImage(2, 1, {0, 255});
  Layer grid{.kind = LayerKind::kGrid, .x = 0.5, .y = 0.5, .size = 0.4, .inner = 0.2};
  grid.intensity = 1;
  grid.pixels = pixels;
  const Field dut = fieldOf({grid});
  EXPECT_EQ(evaluate(dut, 0.35, 0.5), 0);
  EXPECT_NEAR(evaluate(dut, 0.5, 0.5), 0.5, kExact);
  EXPECT_EQ(evaluate(dut, 0.65, 0.5), 1);
  EXPECT_EQ(evaluate(dut, 0.75, 0.5), 0);
}

TEST(LightField, RotatesWithItsLayers) {
  const double turn = 1.1;
  const double cosine = std::cos(turn);
  const double sine = std::sin(turn);
  for (const Layer& layer : oneOfEachKind()) {
    Layer turned = layer;
    turned.angle += turn;
    turned.x = cosine * layer.x - sine * layer.y;
    turned.y = sine * layer.x + cosine * layer.y;
    const CompiledField before(fieldOf({layer}));
    const CompiledField after(fieldOf({turned}));
    for (double x = 0.013; x < 1.2; x += 0.037) {
      for (double y = 0.017; y < 0.9; y += 0.041) {
        ASSERT_NEAR(after.evaluate(cosine * x - sine * y, sine * x + cosine * y),
                    before.evaluate(x, y), 1e-9)
            << "kind " << static_cast<int>(layer.kind) << " at " << x << ", " << y;
      }
    }
  }
}

TEST(LightField, MixesThePreviousWithTheNewLayers) {
  Field dut{{uniform(0.8)}, {disk(0.5, 0.5, 0.2, 0.4)}, 0.25};
  EXPECT_NEAR(evaluate(dut, 0.5, 0.5), 0.75 * 0.4 + 0.25 * 0.8, kExact);
  EXPECT_NEAR(evaluate(dut, 0.1, 0.1), 0.25 * 0.8, kExact);
  dut.mix = 0;
  EXPECT_NEAR(evaluate(dut, 0.5, 0.5), 0.4, kExact);
  dut.mix = 1;
  EXPECT_NEAR(evaluate(dut, 0.5, 0.5), 0.8, kExact);
}

TEST(LightField, ClampsBothEndsOfAMixBeforeMixingThem) {
  const Layer light = uniform(0.8, Blend::kAdd);
  EXPECT_NEAR(evaluate(Field{{}, {light, light}, 0.5}, 0, 0), 0.5, kExact);
}

TEST(LightField, FadeInAListEqualsAMix) {
  const std::vector<Layer> before = {uniform(0.2), disk(0.5, 0.5, 0.2, 0.9)};
  const std::vector<Layer> after = {uniform(0.6), disk(0.6, 0.5, 0.2, 0.5, Blend::kMultiply)};
  const Layer fade{.kind = LayerKind::kFade, .intensity = 0.3};
  std::vector<Layer> frozen = before;
  frozen.push_back(fade);
  frozen.insert(frozen.end(), after.begin(), after.end());
  const Field mixed{after, before, 0.3};
  for (const double x : {0.1, 0.35, 0.5, 0.75}) {
    EXPECT_NEAR(evaluate(fieldOf(frozen), x, 0.5), evaluate(mixed, x, 0.5), kExact);
  }
}

TEST(LightField, DetectsUniformFields) {
  EXPECT_TRUE(isUniform(Field{}));
  EXPECT_TRUE(isUniform(fieldOf({uniform(0.3), uniform(0.5, Blend::kMax)})));
  EXPECT_FALSE(isUniform(fieldOf({uniform(0.3), disk(0, 0, 0.1, 1)})));
  EXPECT_FALSE(isUniform(Field{{uniform(0.3)}, {disk(0, 0, 0.1, 1)}, 0.5}));
  EXPECT_TRUE(isUniform(Field{{uniform(0.3)}, {disk(0, 0, 0.1, 1)}, 1}));
  for (const Layer& layer : oneOfEachKind()) {
    EXPECT_EQ(CompiledField(fieldOf({layer})).isUniform(), isUniform(fieldOf({layer})));
  }
}

TEST(LightField, IsMovingDuringAMix) {
  EXPECT_FALSE(isMoving(fieldOf({uniform(0.3)})));
  EXPECT_TRUE(isMoving(Field{{uniform(0.3)}, {}, 0}));
  EXPECT_TRUE(isMoving(Field{{uniform(0.3)}, {}, 0.99}));
}

TEST(LightOverDisk, IsTheIntensityWhereTheFieldIsUniform) {
  EXPECT_EQ(evaluateOverDisk(fieldOf({uniform(0.37)}), 0.4, 0.4, 0.01), 0.37);
}

TEST(LightOverDisk, IsTheValueAtTheCentreOfALinearGradient) {
  Layer layer{.kind = LayerKind::kLinearGradient, .x = 0.6, .y = 0.4, .angle = 0.5, .size = 1};
  layer.intensity2 = 1;
  const Field dut = fieldOf({layer});
  EXPECT_NEAR(evaluateOverDisk(dut, 0.55, 0.5, 0.05), evaluate(dut, 0.55, 0.5), kExact);
}

TEST(LightOverDisk, IsExactForAPolynomialOfFourthDegree) {
  // Four equal gradients multiplied: (1/2 + x)^4.
  Layer slope{.kind = LayerKind::kLinearGradient, .size = 1};
  slope.intensity2 = 1;
  Layer times = slope;
  times.blend = Blend::kMultiply;
  const Field dut = fieldOf({slope, times, times, times});
  const double r = 0.4;
  // Mean of x^2 over a disk is r^2/4, of x^4 r^4/8.
  const double mean = 1.0 / 16 + 6.0 / 4 * r * r / 4 + r * r * r * r / 8;
  EXPECT_NEAR(evaluateOverDisk(dut, 0, 0, r), mean, kExact);
}

TEST(LightOverDisk, IsHalfOnAHardEdgeThroughItsCentreUpToAStep) {
  Layer layer{.kind = LayerKind::kHalfPlane, .x = 0.6};
  layer.intensity = 1;
  EXPECT_NEAR(evaluateOverDisk(fieldOf({layer}), 0.6, 0.4, 0.01), 0.5, 0.125 + kExact);
}

}  // namespace
}  // namespace lab::light
