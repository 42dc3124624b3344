// Compares the simulated camera's noise with its model: variance = floor + slope signal, plus 1/12
// by rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::camera_painter_noise_test {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kFrames = 60;

struct Statistics {
  double mean = 0;
  double variance = 0;
  double next_pixel = 0;  ///< correlation with the pixel to the right
  double next_row = 0;    ///< correlation with the pixel below
  double next_frame = 0;  ///< correlation with the same pixel in the next frame
};

/// Statistics of 60 frames of a part of an empty floor in uniform light, relative to the expected
/// values.
Statistics measure(double light, double gain) {
  PainterSettings settings;
  settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
  settings.vignetting = 0;
  settings.unevenness = 0;
  settings.hot_pixels = 0;
  settings.texture = false;
  settings.ambient = 0;
  settings.gain = gain;
  CameraPainter painter(settings);
  light::Layer layer;
  layer.intensity = light;
  painter.setLight({{layer}, {}, 1});
  std::vector<std::uint8_t> now(static_cast<std::size_t>(kWidth) * kHeight);
  std::vector<std::uint8_t> before;
  const double expected = settings.imaging.black + kFullSignal * light * gain;
  double sum = 0, squares = 0, right = 0, below = 0, later = 0;
  std::int64_t count = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    painter.paint({}, frame, now);
    for (int y = 60; y < 180; ++y) {
      for (int x = 100; x < 220; ++x) {
        const auto at = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
        const double off = now[at] - expected;
        sum += off;
        squares += off * off;
        right += off * (now[at + 1] - expected);
        below += off * (now[at + kWidth] - expected);
        if (!before.empty()) later += off * (before[at] - expected);
        ++count;
      }
    }
    before = now;
  }
  const auto n = static_cast<double>(count);
  Statistics out;
  out.mean = sum / n;
  out.variance = squares / n - out.mean * out.mean;
  out.next_pixel = right / n / out.variance;
  out.next_row = below / n / out.variance;
  out.next_frame = later / (n * (kFrames - 1) / kFrames) / out.variance;
  return out;
}

TEST(CameraPainterNoise, HasTheModelsMeanAndVarianceAtAnyLightAndGain) {
  const optics::Imaging imaging;
  for (const auto& [light, gain] : {std::pair{1.0, 1.0}, {0.12, 1.0}, {0.5, 2.0}, {0.12, 4.0}}) {
    const Statistics found = measure(light, gain);
    const PixelNoise noise = pixelNoise(imaging, gain);
    const double expected = noise.floor + noise.slope * kFullSignal * light * gain + 1.0 / 12;
    // 864000 values: the standard error of the mean is 0.003, of the variance 0.15 %.
    EXPECT_NEAR(found.mean, 0, 0.02) << light;
    EXPECT_NEAR(found.variance / expected, 1, 0.01) << light;
    EXPECT_NEAR(found.next_pixel, 0, 0.01) << light;
    EXPECT_NEAR(found.next_row, 0, 0.01) << light;
    EXPECT_NEAR(found.next_frame, 0, 0.01) << light;
  }
}

TEST(CameraPainterNoise, GainMultipliesHalfOfTheNoiseInTheDark) {
  const optics::Imaging imaging;
  EXPECT_DOUBLE_EQ(pixelNoise(imaging, 1).floor, 1.2 * 1.2);
  EXPECT_DOUBLE_EQ(pixelNoise(imaging, 3).floor, 1.2 * 1.2 * 5);
  EXPECT_DOUBLE_EQ(pixelNoise(imaging, 3).slope, 0.078);
}

TEST(CameraPainterNoise, RefusesABufferOfAnotherSize) {
  PainterSettings settings;
  settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
  CameraPainter painter(settings);
  std::vector<std::uint8_t> small(100);
  EXPECT_THROW(painter.paint({}, 0, small), std::invalid_argument);
}

}  // namespace
}  // namespace lab::sim::camera_painter_noise_test
