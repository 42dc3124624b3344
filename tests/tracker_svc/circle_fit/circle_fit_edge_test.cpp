// Circles crossed by the edge of a projected pattern.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/circle_picture.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::detector {
namespace {

using testing::CirclePicture;
using testing::roundShape;
using testing::shoot;
using testing::softStep;

using Light = std::function<double(double x, double y)>;

struct Pool {
  int fits = 0;
  int refused = 0;
  int edges = 0;
  int differ = 0;  // number of fits that differ from another start
  double squares = 0;
  double normalised = 0;  // sum of error^T covariance^-1 error

  [[nodiscard]] double rms() const { return std::sqrt(squares / std::max(1, fits - refused)); }
  [[nodiscard]] double nees() const { return normalised / (2.0 * std::max(1, fits - refused)); }
  // Tolerance of the mean normalised squared error: 10 % plus three standard deviations.
  [[nodiscard]] double neesTolerance() const { return 0.1 + 3 * std::sqrt(2.0 / (2.0 * fits)); }
};

class CircleFitEdgeTest : public ::testing::Test {
 protected:
  double even(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  // The light comes from make(radius), relative to the circle's centre.
  Pool fitMany(double radius, int count, const std::function<Light(double)>& make) {
    Pool pool;
    for (int i = 0; i < count; ++i) {
      CirclePicture p;
      p.x = 24 + even(-0.5, 0.5);
      p.y = 24 + even(-0.5, 0.5);
      p.shape = roundShape(radius, 1 + even(0, 0.03), even(0, 3));
      const Light light = make(radius);
      const double cx = p.x;
      const double cy = p.y;
      p.light = [=](double x, double y) { return light(x - cx, y - cy); };
      const optics::GreyImage image = shoot(p, random_);
      const auto start = [&] {
        return optics::Pixel{p.x + even(-1, 1) * 0.17 * radius, p.y + even(-1, 1) * 0.17 * radius};
      };
      const CircleFit fit = fitCircle(image.view(), start(), p.shape, {});
      const CircleFit again = fitCircle(image.view(), start(), p.shape, {});
      ++pool.fits;
      pool.differ += again.x != fit.x || again.y != fit.y ? 1 : 0;
      if (fit.fault != FitFault::kNone) {
        ++pool.refused;
        continue;
      }
      pool.edges += fit.edge ? 1 : 0;
      const double ex = fit.x - p.x;
      const double ey = fit.y - p.y;
      const auto& c = fit.covariance;
      pool.squares += ex * ex + ey * ey;
      pool.normalised +=
          (c[2] * ex * ex - 2 * c[1] * ex * ey + c[0] * ey * ey) / (c[0] * c[2] - c[1] * c[1]);
    }
    return pool;
  }

  std::mt19937_64 random_{21};
};

TEST_F(CircleFitEdgeTest, HalfPlanes) {
  for (const double shade : {0.12, 0.3, 0.6}) {
    for (const double radius : {4.1, 6.7}) {
      const Pool pool = fitMany(radius, 60, [&](double r) -> Light {
        const double angle = even(0, 2 * std::numbers::pi);
        const double offset = even(-0.9, 0.9) * r;
        return [=](double x, double y) {
          return shade +
                 (1 - shade) * softStep(x * std::cos(angle) + y * std::sin(angle) - offset, 1.5);
        };
      });
      EXPECT_EQ(pool.refused, 0) << shade << " " << radius;
      EXPECT_GE(pool.edges, 54) << shade << " " << radius;
      EXPECT_LT(pool.rms(), 0.06) << shade << " " << radius;
      EXPECT_LE(pool.differ, 3) << shade << " " << radius;
    }
  }
}

TEST_F(CircleFitEdgeTest, RimsOfProjectedDiscs) {
  const Pool pool = fitMany(6.7, 60, [&](double r) -> Light {
    const double angle = even(0, 2 * std::numbers::pi);
    const double offset = even(-0.9, 0.9) * r;
    const double disc = even(30, 70);
    return [=](double x, double y) {
      const double away =
          std::hypot(x - (offset - disc) * std::cos(angle), y - (offset - disc) * std::sin(angle));
      return 0.3 + 0.7 * softStep(disc - away, 1.5);
    };
  });
  EXPECT_EQ(pool.refused, 0);
  EXPECT_LT(pool.rms(), 0.06);
}

TEST_F(CircleFitEdgeTest, NarrowStripes) {
  const Pool pool = fitMany(6.7, 60, [&](double) -> Light {
    const double angle = even(0, 2 * std::numbers::pi);
    const double period = 22;
    const double phase = even(0, period);
    return [=](double x, double y) {
      const double along = x * std::cos(angle) + y * std::sin(angle) + phase;
      const double t = along - period * std::floor(along / period);
      const double inside = std::min(t, period / 2 - t);  // half of each period is lit
      const double outside = std::min(t - period / 2, period - t);
      return 0.35 + 0.65 * softStep(inside > 0 ? inside : -outside, 1.5);
    };
  });
  EXPECT_LE(pool.refused, 1);
  EXPECT_LT(pool.rms(), 0.1);
}

// Paint and light change at the same place: the blurred product is not the product of the blurs.
TEST_F(CircleFitEdgeTest, EdgesThatTouchTheOutline) {
  for (const double radius : {4.1, 6.7}) {
    const Pool pool = fitMany(radius, 120, [&](double r) -> Light {
      const double angle = even(0, 2 * std::numbers::pi);
      const double offset = r + even(-1, 1);
      return [=](double x, double y) {
        return 0.3 + 0.7 * softStep(x * std::cos(angle) + y * std::sin(angle) - offset, 0.7);
      };
    });
    EXPECT_EQ(pool.refused, 0) << radius;
    EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance()) << radius;
    EXPECT_LT(pool.rms(), 0.03) << radius;
  }
}

// Light that varies smoothly over a circle, as in waves and noise, has no edge to fit.
TEST_F(CircleFitEdgeTest, SmoothLightGradients) {
  for (const double radius : {4.1, 6.7}) {
    const Pool pool = fitMany(radius, 120, [&](double) -> Light {
      const double angle = even(0, 2 * std::numbers::pi);
      const double phase = even(0, 2 * std::numbers::pi);
      const double length = even(55, 75);
      return [=](double x, double y) {
        const double along = x * std::cos(angle) + y * std::sin(angle);
        return 0.55 + 0.45 * std::sin(2 * std::numbers::pi * along / length + phase);
      };
    });
    EXPECT_EQ(pool.refused, 0) << radius;
    EXPECT_NEAR(pool.nees(), 1, pool.neesTolerance()) << radius;
    EXPECT_LT(pool.rms(), 0.04) << radius;
  }
}

TEST_F(CircleFitEdgeTest, CornersOfACheckerboard) {
  const Pool pool = fitMany(6.7, 60, [&](double r) -> Light {
    const double angle = even(0, 2 * std::numbers::pi);
    const double corner_x = even(-1.1, 1.1) * r;
    const double corner_y = even(-1.1, 1.1) * r;
    return [=](double x, double y) {
      const double u = x * std::cos(angle) + y * std::sin(angle) - corner_x;
      const double v = y * std::cos(angle) - x * std::sin(angle) - corner_y;
      return 0.25 + 0.75 * (0.5 + 0.5 * (2 * softStep(u, 1.5) - 1) * (2 * softStep(v, 1.5) - 1));
    };
  });
  EXPECT_LE(pool.refused, 1);
  EXPECT_LT(pool.rms(), 0.1);
}

// An edge alone, with no circle, must not become one.
TEST_F(CircleFitEdgeTest, AnEdgeWithoutACircleIsRejected) {
  int accepted = 0;
  for (int i = 0; i < 60; ++i) {
    CirclePicture p;
    const double angle = even(0, 2 * std::numbers::pi);
    const double offset = even(-6, 6);
    p.light = [=](double x, double y) {
      return 0.12 +
             0.88 * softStep((x - 24) * std::cos(angle) + (y - 24) * std::sin(angle) - offset, 1.5);
    };
    p.shape = roundShape(1e-3);
    p.x = p.y = 0;
    const optics::GreyImage image = shoot(p, random_);
    const CircleFit fit = fitCircle(image.view(), {24, 24}, roundShape(6.7), {});
    accepted += fit.fault == FitFault::kNone ? 1 : 0;
  }
  EXPECT_EQ(accepted, 0);
}

}  // namespace
}  // namespace lab::detector
