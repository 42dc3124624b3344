/// Simulated robots without collisions, for tests: active Brownian, with alignment if wanted.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "analyzer/collective/crowd_analysis.hpp"

namespace lab::collective {

struct SimulatedCrowdSettings {
  int robots = 30;
  double speed = 0.05;    ///< [m/s]
  double rotation = 0.5;  ///< [rad^2/s] rotational diffusion
  double alignment = 0;   ///< [1/s] with the mean direction of robots within 15 cm
  std::uint64_t seed = 1;
};

/// Points in a periodic arena of 1.2 m x 0.9 m: stationary from the beginning without alignment.
class SimulatedCrowd {
 public:
  explicit SimulatedCrowd(const SimulatedCrowdSettings& settings)
      : settings_(settings), random_(settings.seed) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < settings.robots; ++i) {
      poses_.push_back({i + 1, kWidth * unit(random_), kHeight * unit(random_),
                        2 * 3.14159265358979 * unit(random_), 0, -1});
    }
  }

  void step(double dt) {
    std::normal_distribution<double> normal(0, std::sqrt(2 * settings_.rotation * dt));
    std::vector<double> torques(poses_.size(), 0.0);
    if (settings_.alignment > 0) {
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        for (std::size_t j = 0; j < poses_.size(); ++j) {
          const double dx = std::remainder(poses_[i].x - poses_[j].x, kWidth);
          const double dy = std::remainder(poses_[i].y - poses_[j].y, kHeight);
          if (dx * dx + dy * dy > 0.15 * 0.15) continue;
          torques[i] += std::sin(poses_[j].theta - poses_[i].theta);
        }
      }
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      CrowdPose& pose = poses_[i];
      pose.theta += settings_.alignment * torques[i] * dt + normal(random_);
      pose.x = wrapped(pose.x + settings_.speed * dt * std::cos(pose.theta), kWidth);
      pose.y = wrapped(pose.y + settings_.speed * dt * std::sin(pose.theta), kHeight);
    }
  }

  [[nodiscard]] const std::vector<CrowdPose>& poses() const { return poses_; }

 private:
  static constexpr double kWidth = 1.2;
  static constexpr double kHeight = 0.9;

  static double wrapped(double x, double length) { return x - length * std::floor(x / length); }

  SimulatedCrowdSettings settings_;
  std::mt19937_64 random_;
  std::vector<CrowdPose> poses_;
};

}  // namespace lab::collective
