#include "light/optics/camera_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "light/optics/simulated_camera.hpp"

namespace lab::optics {
namespace {

/// A tilted camera; the expected pixels of two robots' axes at 5 cm come from OpenCV's
/// projectPoints().
CameraParameters tiltedCamera() {
  CameraParameters p;
  p.width = 1280;
  p.height = 720;
  p.fx = 1250.909090909091;
  p.fy = 1251.7847272727272;
  p.cx = 647.18;
  p.cy = 353.74;
  p.k1 = -0.12;
  p.k2 = 0.02;
  p.p1 = 0.0004;
  p.p2 = -0.0003;
  p.rotation = {0.9987058727081077,   0.0291548745577585,   0.04167221025885546,
                0.026152033653420895, -0.997142560466884,   0.07087161096896727,
                0.043619387365336,    -0.06969008103788994, -0.9966145903260724};
  p.translation = {-0.6220387271573594, 0.4227899860870422, 1.7298984938836674};
  return p;
}

TEST(CameraModel, ProjectsAsOpenCvDoes) {
  const CameraModel camera(tiltedCamera());
  const Pixel first = camera.project(0.12797408, 0.57489198, 0.05);
  EXPECT_NEAR(first.x, 289.62807, 2e-4);
  EXPECT_NEAR(first.y, 245.73784, 2e-4);
  const Pixel second = camera.project(0.42011081, 0.57688615, 0.05);
  EXPECT_NEAR(second.x, 509.00923, 2e-4);
  EXPECT_NEAR(second.y, 249.87308, 2e-4);
}

TEST(CameraModel, ReturnsTheCamerasPosition) {
  const auto centre = CameraModel(tiltedCamera()).centre();
  EXPECT_NEAR(centre[0], 0.53471979941, 1e-9);
  EXPECT_NEAR(centre[1], 0.56027411654, 1e-9);
  EXPECT_NEAR(centre[2], 1.72, 1e-9);
}

TEST(CameraModel, MapsPixelsBackToPlaces) {
  const CameraModel camera(tiltedCamera());
  for (const double z : {0.0, 0.05}) {
    for (double x = 0; x <= 1.2; x += 0.1) {
      for (double y = 0; y <= 0.9; y += 0.1) {
        const auto place = camera.toPlane(camera.project(x, y, z), z);
        ASSERT_TRUE(place);
        EXPECT_NEAR(place->x, x, 1e-11);
        EXPECT_NEAR(place->y, y, 1e-11);
      }
    }
  }
}

TEST(CameraModel, ReturnsTheDerivativeOfTheProjection) {
  constexpr double kStep = 1e-6;
  const CameraModel camera(tiltedCamera());
  for (double x = 0.05; x < 1.2; x += 0.22) {
    for (double y = 0.05; y < 0.9; y += 0.2) {
      const PlaneScale scale = camera.scaleAt({x, y}, 0.05);
      const Pixel east = camera.project(x + kStep, y, 0.05);
      const Pixel west = camera.project(x - kStep, y, 0.05);
      const Pixel north = camera.project(x, y + kStep, 0.05);
      const Pixel south = camera.project(x, y - kStep, 0.05);
      EXPECT_NEAR(scale.ux, (east.x - west.x) / (2 * kStep), 1e-3);
      EXPECT_NEAR(scale.vx, (east.y - west.y) / (2 * kStep), 1e-3);
      EXPECT_NEAR(scale.uy, (north.x - south.x) / (2 * kStep), 1e-3);
      EXPECT_NEAR(scale.vy, (north.y - south.y) / (2 * kStep), 1e-3);
    }
  }
}

TEST(CameraModel, ReturnsNothingIfALineOfSightMissesThePlane) {
  CameraParameters p = tiltedCamera();
  EXPECT_FALSE(CameraModel(p).toPlane({640, 360}, 2.0));  // above the camera
  p.k1 = -0.5;                                            // not invertible inside the picture
  EXPECT_FALSE(CameraModel(p).toPlane({-2000, 360}, 0.05));
}

TEST(SimulatedCamera, SeesTheWholeArenaAndLittleElse) {
  for (const auto& [columns, rows] : {std::pair{1280, 720}, {1920, 1080}, {640, 480}}) {
    for (const auto& [width, height] : {std::pair{1.2, 0.9}, {3.0, 2.0}}) {
      const CameraModel camera(simulatedCamera(columns, rows, width, height));
      double low = rows;
      double high = 0;
      double left = columns;
      double right = 0;
      for (const double z : {0.0, 0.05}) {
        for (const double x : {0.0, width}) {
          for (const double y : {0.0, height}) {
            const Pixel pixel = camera.project(x, y, z);
            low = std::min(low, pixel.y);
            high = std::max(high, pixel.y);
            left = std::min(left, pixel.x);
            right = std::max(right, pixel.x);
          }
        }
      }
      EXPECT_GT(low, 0);
      EXPECT_LT(high, rows - 1);
      EXPECT_GT(left, 0);
      EXPECT_LT(right, columns - 1);
      EXPECT_GT(std::max((right - left) / columns, (high - low) / rows), 0.85);
      // Not mirrored: y of the arena is up, x is right.
      const PlaneScale scale = camera.scaleAt({width / 2, height / 2}, 0.05);
      EXPECT_GT(scale.ux, 0);
      EXPECT_LT(scale.vy, 0);
    }
  }
}

}  // namespace
}  // namespace lab::optics
