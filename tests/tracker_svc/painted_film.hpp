/// A short recording of robots driving in circles, painted by the simulated camera.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::tracker {

class PaintedFilm {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;
  static constexpr double kFps = 30;

  /// @param gamma of the grey values, as in optics::Imaging
  explicit PaintedFilm(double gamma = 1) : painter_(settings(gamma)) { setLight(0.8); }

  void setLight(double intensity) {
    light::Layer light;
    light.intensity = intensity;
    painter_.setLight({{light}, {}, 1});
  }

  static sim::PainterSettings settings(double gamma = 1) {
    sim::PainterSettings settings;
    settings.imaging.gamma = gamma;
    settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
    return settings;
  }

  /// Three robots on circles of 8 cm radius at 10 cm/s, far apart.
  [[nodiscard]] static std::vector<sim::PaintedRobot> robotsAt(double time) {
    constexpr double kRadius = 0.08;
    constexpr double kSpeed = 0.10;
    std::vector<sim::PaintedRobot> robots;
    for (int i = 0; i < 3; ++i) {
      const double angle = kSpeed / kRadius * time + i;
      const double heading = angle + std::numbers::pi / 2;
      robots.push_back({0.25 + 0.35 * i + kRadius * std::cos(angle),
                        0.3 + 0.15 * i + kRadius * std::sin(angle),
                        std::remainder(heading, 2 * std::numbers::pi), kSpeed * std::cos(heading),
                        kSpeed * std::sin(heading), kSpeed / kRadius});
    }
    return robots;
  }

  [[nodiscard]] optics::GreyImage paint(const std::vector<sim::PaintedRobot>& robots,
                                        std::int64_t number) {
    optics::GreyImage picture(kWidth, kHeight);
    painter_.paint(robots, number, picture.pixels);
    return picture;
  }

  [[nodiscard]] optics::GreyImage frame(std::int64_t number) {
    return paint(robotsAt(timeOf(number)), number);
  }

  [[nodiscard]] static double timeOf(std::int64_t number) {
    return static_cast<double>(number) / kFps;
  }

 private:
  sim::CameraPainter painter_;
};

}  // namespace lab::tracker
