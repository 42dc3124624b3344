#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/held_noise_law.hpp"
#include "analyzer/laws/persistent_msd.hpp"

namespace lab::analysis {
namespace forms {
std::vector<ClosedForm> abp();
}
namespace {

/// Constant speed v; every epsilon a turning rate is drawn from +-eta.
class Abp : public HeldNoiseLaw {
 public:
  Abp(std::vector<LawParameter> parameters, double wheel_base)
      : HeldNoiseLaw("abp", std::move(parameters), wheel_base),
        v_(parameter("v")),
        eta_(parameter("eta")) {}

  [[nodiscard]] std::string title() const override { return "ABP"; }
  [[nodiscard]] std::shared_ptr<const LawCurves> curves(const Turning&) const override {
    if (!(hold() > 0)) return nullptr;
    return std::make_shared<const HeldNoiseCurves>(heldNoise(), v_);
  }

  [[nodiscard]] double rotationalDiffusivity() const override { return hold() * eta_ * eta_ / 6; }
  [[nodiscard]] double meanSpeed() const override { return v_; }
  [[nodiscard]] double neededWheelSpeed(double) const override {
    return std::abs(v_) + 0.5 * eta_ * wheelBase();
  }

  [[nodiscard]] double paperMsd(double tau) const override {
    return exponentialMsd(v_ * v_, rotationalDiffusivity(), tau);
  }
  [[nodiscard]] std::string paperFormula() const override { return "eq. 4"; }

  [[nodiscard]] double persistenceTime() const override { return 1 / rotationalDiffusivity(); }
  [[nodiscard]] double variationRate() const override { return eta_; }
  [[nodiscard]] std::optional<HeldDraws> held() const override { return HeldDraws{hold(), 0.8}; }
  [[nodiscard]] std::optional<double> constantSpeed() const override { return v_; }
  [[nodiscard]] std::shared_ptr<const HeldNoise> heldNoise() const override {
    return std::make_shared<const HeldNoise>(HeldNoise::uniformTurning(v_, eta_, hold()));
  }

  [[nodiscard]] std::unique_ptr<Motion> motion() const override {
    class Walk : public Motion {
     public:
      explicit Walk(const Abp& abp) : v_(abp.v_), eta_(abp.eta_), hold_(abp.hold()) {}
      Arc first(Random& random) override {
        Arc arc = next(random);
        arc.duration = random.uniform(0, hold_);
        return arc;
      }
      Arc next(Random& random) override { return {v_, random.uniform(-eta_, eta_), hold_}; }

     private:
      double v_, eta_, hold_;
    };
    return std::make_unique<Walk>(*this);
  }

  [[nodiscard]] std::string speedParameter() const override { return "v"; }
  [[nodiscard]] std::optional<ProgramLaw> measured(const MeasuredMotion& motion) const override {
    return closedForm(name(),
                      {{"v", motion.speed},
                       {"epsilon", hold()},
                       {"eta", std::sqrt(6 * motion.rotational_diffusivity / hold())}},
                      wheelBase());
  }
  [[nodiscard]] std::vector<FitParameter> fitParameters() const override {
    return {{"v", "v", "m/s"}, {"eta", "eta", "rad/s"}};
  }
  [[nodiscard]] double relativeMsdError(double tau, double, double observed) const override {
    return std::sqrt(2 * tau / 3 / observed);
  }
  [[nodiscard]] double relativeAngularError(double tau, double observed) const override {
    return std::sqrt((4 * tau / 3 + 0.8 * hold()) / observed);
  }
  /// The ballistic part has a much smaller error than the diffusive formula.
  [[nodiscard]] bool predictsMsdError() const override { return false; }

 private:
  double v_;
  double eta_;
};

}  // namespace

std::vector<ClosedForm> forms::abp() {
  return {{"abp",
           {{"v", "v", "m/s", 0.03}, {"epsilon", "ε", "s", 0.5}, {"eta", "η", "rad/s", 3}},
           [](std::vector<LawParameter> parameters, double wheel_base) {
             return std::shared_ptr<const Law>(
                 std::make_shared<const Abp>(std::move(parameters), wheel_base));
           }}};
}

}  // namespace lab::analysis
