#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analyzer/laws/held_noise.hpp"
#include "analyzer/laws/law.hpp"

namespace lab::analysis {

/// The curves of HeldNoise.
class HeldNoiseCurves : public LawCurves {
 public:
  /// @param speed if it is constant, m/s; else 0
  explicit HeldNoiseCurves(std::shared_ptr<const HeldNoise> noise, double speed = 0)
      : noise_(std::move(noise)), speed_(speed) {}

  [[nodiscard]] double msd(double tau) const override { return noise_->msd(tau); }
  [[nodiscard]] double angularMsd(double tau) const override { return noise_->angularMsd(tau); }
  [[nodiscard]] double velocityCorrelation(double s) const override {
    return noise_->velocityCorrelation(s);
  }
  [[nodiscard]] double diffusivity() const override { return noise_->diffusivity(); }
  /// C(l) = g(l / v) and int_0^inf C_v ds = 2 D.
  [[nodiscard]] double persistenceLength() const override {
    return speed_ > 0 ? 2 * noise_->diffusivity() / speed_ : units::kNan;
  }

 private:
  std::shared_ptr<const HeldNoise> noise_;
  double speed_;
};

/// What all laws have in common whose draws are held for a fixed time.
class HeldNoiseLaw : public Law {
 public:
  HeldNoiseLaw(std::string name, std::vector<LawParameter> parameters, double wheel_base)
      : Law(std::move(name), std::move(parameters), wheel_base), hold_(parameter("epsilon")) {}

  [[nodiscard]] double drawTime() const override { return hold_; }
  [[nodiscard]] double changeTime() const override { return hold_; }
  [[nodiscard]] double longestChange() const override { return 8 * hold_; }
  [[nodiscard]] double kinkSpacing() const override { return hold_; }
  [[nodiscard]] double steadyHold() const override { return hold_; }
  [[nodiscard]] std::vector<FitParameter> fitTimes() const override {
    return {{"epsilon", "epsilon", "s"}};
  }

 protected:
  [[nodiscard]] double hold() const { return hold_; }

 private:
  double hold_;
};

}  // namespace lab::analysis
