/// Simulated robots without collisions, for tests: active Brownian, with alignment if wanted.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
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

/// Points in an arena of 1.2 m x 0.9 m whose walls reflect them as mirrors do: uniform and without
/// preferred direction from the beginning, if they do not align.
class SimulatedCrowd {
 public:
  explicit SimulatedCrowd(const SimulatedCrowdSettings& settings)
      : settings_(settings), random_(settings.seed) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < settings.robots; ++i) {
      poses_.push_back({i + 1, kWidth * unit(random_), kHeight * unit(random_),
                        2 * std::numbers::pi * unit(random_), 0, -1});
    }
  }

  void step(double dt) {
    std::normal_distribution<double> normal(0, std::sqrt(2 * settings_.rotation * dt));
    std::vector<double> torques(poses_.size(), 0.0);
    if (settings_.alignment > 0) {
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        for (std::size_t j = 0; j < poses_.size(); ++j) {
          const double dx = poses_[i].x - poses_[j].x;
          const double dy = poses_[i].y - poses_[j].y;
          if (dx * dx + dy * dy > 0.15 * 0.15) continue;
          torques[i] += std::sin(poses_[j].theta - poses_[i].theta);
        }
      }
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      CrowdPose& pose = poses_[i];
      pose.theta += settings_.alignment * torques[i] * dt + normal(random_);
      pose.x += settings_.speed * dt * std::cos(pose.theta);
      pose.y += settings_.speed * dt * std::sin(pose.theta);
      if (pose.x < 0 || pose.x > kWidth) {
        pose.x = pose.x < 0 ? -pose.x : 2 * kWidth - pose.x;
        pose.theta = std::numbers::pi - pose.theta;
      }
      if (pose.y < 0 || pose.y > kHeight) {
        pose.y = pose.y < 0 ? -pose.y : 2 * kHeight - pose.y;
        pose.theta = -pose.theta;
      }
    }
  }

  [[nodiscard]] const std::vector<CrowdPose>& poses() const { return poses_; }

 private:
  static constexpr double kWidth = 1.2;
  static constexpr double kHeight = 0.9;

  SimulatedCrowdSettings settings_;
  std::mt19937_64 random_;
  std::vector<CrowdPose> poses_;
};

}  // namespace lab::collective
