#include "tracker_svc/circle_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/circle_picture.hpp"

namespace lab::detector {
namespace {

using testing::CirclePicture;
using testing::paintExact;
using testing::roundShape;
using testing::shoot;
using testing::softStep;

// Picture of a circle that moves by `along` [px] during the exposure.
std::vector<double> smeared(CirclePicture p, double along, double angle) {
  constexpr int kPieces = 8;
  const double x = p.x;
  const double y = p.y;
  std::vector<double> sum(static_cast<std::size_t>(p.size) * static_cast<std::size_t>(p.size));
  for (int i = 0; i < kPieces; ++i) {
    const double away = along * ((i + 0.5) / kPieces - 0.5);
    p.x = x + away * std::cos(angle);
    p.y = y + away * std::sin(angle);
    const std::vector<double> piece = paintExact(p);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += piece[k] / kPieces;
  }
  return sum;
}

// Errors of many fits, each with its own place, noise and start within a quarter of the radius.
struct Pool {
  int fits = 0;
  int refused = 0;
  int edges = 0;
  double squares = 0;     // [px^2] of the 2-D errors
  double normalised = 0;  // sum of error^T covariance^-1 error
  double sum_x = 0, sum_y = 0;
  double worst = 0;  // [px]

  [[nodiscard]] double rms() const { return std::sqrt(squares / std::max(1, fits - refused)); }
  [[nodiscard]] double nees() const { return normalised / (2.0 * std::max(1, fits - refused)); }
  // Tolerance of the mean normalised squared error: 10 % plus three standard deviations.
  [[nodiscard]] double neesTolerance() const { return 0.1 + 3 * std::sqrt(2.0 / (2.0 * fits)); }
};

class CircleFitTest : public ::testing::Test {
 protected:
  double even(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  CirclePicture picture(double radius) {
    CirclePicture p;
    p.x = 24 + even(-0.5, 0.5);
    p.y = 24 + even(-0.5, 0.5);
    p.shape = roundShape(radius, 1 + even(0, 0.04), even(0, 3));
    return p;
  }

  optics::Pixel startNear(const CirclePicture& p) {
    const double far = 0.25 * static_cast<double>(p.shape.radius()) * std::sqrt(even(0, 1));
    const double angle = even(0, 2 * std::numbers::pi);
    return {p.x + far * std::cos(angle), p.y + far * std::sin(angle)};
  }

  template <typename Change>
  Pool fitMany(double radius, int count, const Change& change) {
    return fitMany(radius, count, change, paintExact);
  }

  template <typename Change, typename Paint>
  Pool fitMany(double radius, int count, const Change& change, const Paint& paint) {
    Pool pool;
    CirclePicture p;
    std::vector<double> exact;
    for (int i = 0; i < count; ++i) {
      if (i % 4 == 0) {  // painting is slow: four noise realisations of each picture
        p = picture(radius);
        change(p);
        exact = paint(p);
      }
      const optics::GreyImage image = shoot(p, exact, random_);
      const CircleFit fit = fitCircle(image.view(), startNear(p), p.shape, {});
      ++pool.fits;
      if (fit.fault != FitFault::kNone) {
        ++pool.refused;
        continue;
      }
      const double ex = fit.x - p.x;
      const double ey = fit.y - p.y;
      const auto& c = fit.covariance;
      pool.edges += fit.edge ? 1 : 0;
      pool.squares += ex * ex + ey * ey;
      pool.worst = std::max(pool.worst, std::hypot(ex, ey));
      pool.normalised +=
          (c[2] * ex * ex - 2 * c[1] * ex * ey + c[0] * ey * ey) / (c[0] * c[2] - c[1] * c[1]);
      pool.sum_x += ex;
      pool.sum_y += ey;
    }
    return pool;
  }

  std::mt19937_64 random_{20};
};

// Cramer-Rao bound of one coordinate with everything but the centre known.
double bound(const CirclePicture& p) {
  const double contrast = p.white * (1 - p.ratio);
  const double variance = p.imaging.read_noise * p.imaging.read_noise +
                          p.imaging.shot_gain * 0.5 * p.white + 1.0 / 12.0 +
                          std::pow(p.grain * 0.5 * p.white, 2);
  const double blur = std::sqrt(p.imaging.blur * p.imaging.blur + 1.0 / 12.0);
  return std::sqrt(variance) / contrast *
         std::sqrt(2 * blur /
                   (std::sqrt(std::numbers::pi) * static_cast<double>(p.shape.radius())));
}

TEST_F(CircleFitTest, InEvenLightItReachesTheCramerRaoBoundWithoutBias) {
  for (const double radius : {3.4, 4.1, 6.7, 10.0}) {
    const int count = 120;
    const Pool pool = fitMany(radius, count, [](CirclePicture&) {});
    CirclePicture p;
    p.shape = roundShape(radius);
    const double least = std::sqrt(2.0) * bound(p);
    EXPECT_EQ(pool.refused, 0) << radius;
    EXPECT_EQ(pool.edges, 0) << radius;
    EXPECT_LT(pool.rms(), 1.4 * least) << radius;
    EXPECT_GT(pool.rms(), 0.8 * least) << radius;  // below the bound the test itself is wrong
    EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance()) << radius;
    const double allowed = 4 * pool.rms() / std::sqrt(2.0 * count);
    EXPECT_LT(std::abs(pool.sum_x / count), allowed) << radius;
    EXPECT_LT(std::abs(pool.sum_y / count), allowed) << radius;
  }
}

TEST_F(CircleFitTest, InDimLightItIsFoundAndTheCovarianceHolds) {
  for (const double light : {0.12, 0.05, 0.03}) {
    for (const double radius : {4.1, 6.7}) {
      const Pool pool = fitMany(radius, 200, [&](CirclePicture& p) { p.white = 190 * light; });
      CirclePicture p;
      p.shape = roundShape(radius);
      p.white = 190 * light;
      EXPECT_EQ(pool.refused, 0) << light << " " << radius;
      EXPECT_LT(pool.rms(), 1.5 * std::sqrt(2.0) * bound(p)) << light << " " << radius;
      EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance()) << light << " " << radius;
    }
  }
}

TEST_F(CircleFitTest, TheCovarianceFollowsUnspecifiedNoise) {
  const Pool pool = fitMany(6.7, 200, [](CirclePicture& p) {
    p.imaging.read_noise = 4;
    p.imaging.shot_gain = 0.2;
  });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance());
}

// A smeared outline has another shape, but a symmetric one.
TEST_F(CircleFitTest, SymmetricResidualsDoNotWidenTheCovariance) {
  const Pool pool = fitMany(
      4.1, 80, [](CirclePicture&) {},
      [&](const CirclePicture& p) { return smeared(p, 2.2, even(0, 2 * std::numbers::pi)); });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance());
}

TEST_F(CircleFitTest, EveryStartWithinAQuarterRadiusGivesTheSameBits) {
  for (const double light : {1.0, 0.05}) {
    for (int i = 0; i < 150; ++i) {
      CirclePicture p = picture(i % 2 == 0 ? 6.7 : 4.1);
      p.white = 190 * light;
      const optics::GreyImage image = shoot(p, random_);
      const CircleFit first = fitCircle(image.view(), startNear(p), p.shape, {});
      for (int other = 0; other < 6; ++other) {
        const CircleFit again = fitCircle(image.view(), startNear(p), p.shape, {});
        ASSERT_EQ(again.fault, first.fault) << light << " " << i;
        ASSERT_EQ(again.x, first.x) << light << " " << i;
        ASSERT_EQ(again.y, first.y) << light << " " << i;
        ASSERT_EQ(again.covariance, first.covariance) << light << " " << i;
      }
    }
  }
}

TEST_F(CircleFitTest, ALightGradientDoesNotDisplaceTheCircle) {
  const Pool pool = fitMany(6.7, 100, [](CirclePicture& p) {
    p.light = [](double x, double) { return 0.5 + 0.01 * (x - 24); };
  });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_LT(pool.rms(), 0.015);
  EXPECT_LT(std::abs(pool.sum_x / 100), 0.004);
}

TEST_F(CircleFitTest, HolesRimsAndHotPixelsDoNotBias) {
  const Pool pool = fitMany(6.7, 100, [this](CirclePicture& p) {
    const double px = 6.7 / 0.9;  // pixels per centimetre
    p.sensor_hole = even(0, 6.3);
    p.hole_distance = 1.45 * px;
    p.hole_radius = 0.2 * px;
    const double cx = p.x - 1.8 * px * std::cos(p.sensor_hole);
    const double cy = p.y - 1.8 * px * std::sin(p.sensor_hole);
    p.around = [=](double x, double y) { return std::hypot(x - cx, y - cy) < 3.6 * px ? 1 : 0.3; };
  });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_EQ(pool.edges, 0);
  EXPECT_LT(pool.rms(), 0.0105);

  for (int i = 0; i < 30; ++i) {
    const CirclePicture p = picture(6.7);
    optics::GreyImage image = shoot(p, random_);
    const CircleFit clean = fitCircle(image.view(), startNear(p), p.shape, {});
    const int column = static_cast<int>(std::lround(p.x + even(-6, 6)));
    image.row(static_cast<int>(std::lround(p.y + even(-6, 6))))[column] = 255;
    const CircleFit hot = fitCircle(image.view(), startNear(p), p.shape, {});
    ASSERT_EQ(hot.fault, FitFault::kNone);
    EXPECT_LT(std::hypot(hot.x - clean.x, hot.y - clean.y), 0.02) << i;
  }
}

TEST_F(CircleFitTest, OverexposureAndDefocusDoNotBias) {
  const Pool over = fitMany(6.7, 80, [](CirclePicture& p) { p.white = 300; });
  EXPECT_EQ(over.refused, 0);
  EXPECT_LT(over.rms(), 0.02);
  const Pool soft = fitMany(6.7, 80, [](CirclePicture& p) { p.imaging.blur = 1.5; });
  EXPECT_EQ(soft.refused, 0);
  EXPECT_LT(soft.rms(), 0.016);
  const Pool softer = fitMany(4.1, 80, [](CirclePicture& p) { p.imaging.blur = 2.5; });
  EXPECT_EQ(softer.refused, 0);
  EXPECT_LT(softer.rms(), 0.06);
}

// Glare adds the same light to paint and white: the ratio rises, the centre stays.
TEST_F(CircleFitTest, GlareOverACircleIsAcceptedAsGlare) {
  const Pool pool = fitMany(6.7, 40, [](CirclePicture& p) {
    p.white = 220;
    p.ratio = (0.0814 * 180 + 40) / 220;
  });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_EQ(pool.edges, 0);
  EXPECT_LT(pool.rms(), 0.0125);
}

TEST_F(CircleFitTest, ReturnsRatioScaleAndWhite) {
  CirclePicture p = picture(6.7);
  p.ratio = 0.1;
  const DiscShape expected = p.shape;
  for (float& m : p.shape.m) m /= 1.04F;
  const CircleFit fit = fitCircle(shoot(p, random_).view(), startNear(p), expected, {});
  ASSERT_EQ(fit.fault, FitFault::kNone);
  EXPECT_NEAR(fit.ratio, 0.1, 0.005);
  EXPECT_NEAR(fit.scale, 1.04, 0.005);
  EXPECT_NEAR(fit.white, 190, 2);
  EXPECT_FALSE(fit.edge);
}

TEST_F(CircleFitTest, StrideAndBorderOfThePictureChangeNothing) {
  const CirclePicture p = picture(6.7);
  const optics::GreyImage image = shoot(p, random_);
  const CircleFit whole = fitCircle(image.view(), {24, 24}, p.shape, {});
  // The same pixels, with the picture's edge close to the circle, inside a larger buffer.
  optics::GreyView cut = image.view();
  cut.data += 10 * cut.stride + 10;
  cut.width = 28;
  cut.height = 28;
  const CircleFit part = fitCircle(cut, {14, 14}, p.shape, {});
  ASSERT_EQ(part.fault, FitFault::kNone);
  EXPECT_EQ(part.x + 10, whole.x);
  EXPECT_EQ(part.y + 10, whole.y);
  // The edge cuts the white around the circle: fewer pixels, but a fit.
  cut.data += 6;
  cut.width -= 6;
  const CircleFit less = fitCircle(cut, {8, 14}, p.shape, {});
  ASSERT_EQ(less.fault, FitFault::kNone);
  EXPECT_NEAR(less.x + 16, whole.x, 0.05);
  // The edge cuts the circle: no fit from any start.
  cut.data += 6;
  cut.width -= 6;
  for (const double x : {-3.0, 0.0, 2.0}) {
    EXPECT_NE(fitCircle(cut, {x, 14}, p.shape, {}).fault, FitFault::kNone) << x;
  }
}

TEST_F(CircleFitTest, OtherShapesAreRejected) {
  struct Thing {
    std::string name;
    std::function<double(double, double)> paint;  // around (0, 0)
  };
  const double r = 6.7;
  const std::vector<Thing> things = {
      {"white paper", [](double, double) { return 1.0; }},
      {"grey disc", [=](double x, double y) { return std::hypot(x, y) < r ? 0.4 : 1; }},
      {"half the size", [=](double x, double y) { return std::hypot(x, y) < 0.5 * r ? 0.08 : 1; }},
      {"twice the size", [=](double x, double y) { return std::hypot(x, y) < 2 * r ? 0.08 : 1; }},
      {"square", [=](double x, double y) { return std::abs(x) < r && std::abs(y) < r ? 0.08 : 1; }},
      {"tape", [=](double x, double) { return std::abs(x) < 0.6 * r ? 0.08 : 1; }},
      {"border", [](double x, double) { return x < 0 ? 0.08 : 1; }},
      {"half disc", [=](double x, double y) { return std::hypot(x, y) < r && x > 0 ? 0.08 : 1; }},
      {"ring",
       [=](double x, double y) {
         const double d = std::hypot(x, y);
         return d < r && d > 0.6 * r ? 0.08 : 1;
       }},
      {"scratch", [](double x, double y) { return std::abs(x - 0.3 * y) < 1 ? 0.3 : 1; }},
  };
  for (const Thing& thing : things) {
    for (const double light : {1.0, 0.12}) {
      int accepted = 0;
      for (int i = 0; i < 20; ++i) {
        CirclePicture p = picture(r);
        const double x = p.x;
        const double y = p.y;
        p.white = 190 * light;
        p.around = [&, x, y](double u, double v) { return thing.paint(u - x, v - y); };
        const DiscShape expected = p.shape;
        p.shape = roundShape(1e-3);  // paints no circle itself
        p.x = p.y = 0;
        const optics::GreyImage image = shoot(p, random_);
        const CircleFit fit =
            fitCircle(image.view(), {x + even(-1, 1), y + even(-1, 1)}, expected, {});
        accepted += fit.fault == FitFault::kNone ? 1 : 0;
      }
      EXPECT_EQ(accepted, 0) << thing.name << " at light " << light;
    }
  }
}

}  // namespace
}  // namespace lab::detector
