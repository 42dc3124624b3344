#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/laws/bp_kurtosis.hpp"
#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/held_noise_law.hpp"
#include "analyzer/laws/persistent_msd.hpp"

namespace lab::analysis {
namespace forms {
std::vector<ClosedForm> noisy_abp();
}
namespace {

/// Every epsilon both wheel speeds are drawn from va +- V. The Brownian particle is the same with
/// va = 0, which has other properties.
class DrawnWheelsLaw : public HeldNoiseLaw {
 public:
  DrawnWheelsLaw(std::string name, std::vector<LawParameter> parameters, double wheel_base,
                 bool brownian)
      : HeldNoiseLaw(std::move(name), std::move(parameters), wheel_base),
        brownian_(brownian),
        va_(brownian ? 0 : parameter("va")),
        amplitude_(parameter("V")) {}

  [[nodiscard]] std::string title() const override { return brownian_ ? "BP" : "noisy ABP"; }
  [[nodiscard]] std::shared_ptr<const LawCurves> curves(const Turning&) const override {
    return curvesAtMean(va_);
  }
  [[nodiscard]] std::shared_ptr<const LawCurves> curvesAtMean(double mean) const override {
    if (!exists()) return nullptr;
    return std::make_shared<const HeldNoiseCurves>(noiseAt(mean));
  }

  [[nodiscard]] double rotationalDiffusivity() const override {
    return hold() * amplitude_ * amplitude_ / (3 * wheelBase() * wheelBase());
  }
  [[nodiscard]] double translationalDiffusivity() const override {
    return hold() * amplitude_ * amplitude_ / 24;
  }
  [[nodiscard]] double meanSpeed() const override { return va_; }
  [[nodiscard]] double neededWheelSpeed(double) const override {
    return std::abs(va_) + amplitude_;
  }

  [[nodiscard]] double paperMsd(double tau) const override {
    const double spread = 4 * translationalDiffusivity() * tau;
    return brownian_ ? spread : spread + exponentialMsd(va_ * va_, rotationalDiffusivity(), tau);
  }
  [[nodiscard]] std::string paperFormula() const override { return "eq. 5"; }

  [[nodiscard]] double persistenceTime() const override {
    return brownian_ ? hold() : 1 / rotationalDiffusivity();
  }
  [[nodiscard]] double variationRate() const override { return 2 * amplitude_ / wheelBase(); }
  [[nodiscard]] std::optional<HeldDraws> held() const override { return HeldDraws{hold(), 1.4}; }
  [[nodiscard]] std::optional<DrawnWheels> drawnWheels() const override {
    return DrawnWheels{va_, amplitude_};
  }
  [[nodiscard]] bool isDiffusive() const override { return brownian_; }
  [[nodiscard]] std::shared_ptr<const HeldNoise> heldNoise() const override { return noiseAt(va_); }
  [[nodiscard]] std::shared_ptr<const DisplacementKurtosis> kurtosis() const override {
    if (!brownian_ || !exists()) return nullptr;
    return std::make_shared<const BpKurtosis>(amplitude_, wheelBase(), hold());
  }

  [[nodiscard]] std::unique_ptr<Motion> motion() const override {
    class Walk : public Motion {
     public:
      explicit Walk(const DrawnWheelsLaw& law)
          : va_(law.va_), amplitude_(law.amplitude_), base_(law.wheelBase()), hold_(law.hold()) {}
      Arc first(Random& random) override {
        Arc arc = next(random);
        arc.duration = random.uniform(0, hold_);
        return arc;
      }
      Arc next(Random& random) override {
        const double left = random.uniform(va_ - amplitude_, va_ + amplitude_);
        const double right = random.uniform(va_ - amplitude_, va_ + amplitude_);
        return {0.5 * (left + right), (right - left) / base_, hold_};
      }

     private:
      double va_, amplitude_, base_, hold_;
    };
    return std::make_unique<Walk>(*this);
  }

  [[nodiscard]] std::string speedName() const override { return brownian_ ? "v" : "v_a"; }
  [[nodiscard]] std::string speedParameter() const override { return brownian_ ? "" : "va"; }
  [[nodiscard]] std::string characteristicEstimate() const override {
    return brownian_ ? "D_t" : "D_r";
  }
  [[nodiscard]] std::optional<ProgramLaw> measured(const MeasuredMotion& motion) const override {
    if (brownian_) {
      return closedForm(name(), {{"V", motion.amplitude}, {"epsilon", hold()}}, wheelBase());
    }
    return closedForm(name(), {{"va", motion.speed}, {"V", motion.amplitude}, {"epsilon", hold()}},
                      wheelBase());
  }
  [[nodiscard]] std::vector<FitParameter> fitParameters() const override {
    if (brownian_) return {{"V", "V", "m/s"}};
    return {{"va", "v_a", "m/s"}, {"V", "V", "m/s"}};
  }
  [[nodiscard]] double relativeMsdError(double tau, double msd, double observed) const override {
    const double noise_share = std::min(1.0, 4 * translationalDiffusivity() * tau / msd);
    return std::sqrt((2 * tau / 3 * (1 + noise_share) + 1.5 * noise_share * hold()) / observed);
  }
  [[nodiscard]] double relativeAngularError(double tau, double observed) const override {
    return std::sqrt((4 * tau / 3 + 1.4 * hold()) / observed);
  }

 private:
  [[nodiscard]] bool exists() const { return hold() > 0 && wheelBase() > 0; }
  [[nodiscard]] std::shared_ptr<const HeldNoise> noiseAt(double mean) const {
    return std::make_shared<const HeldNoise>(
        HeldNoise::uniformWheels(mean, amplitude_, wheelBase(), hold()));
  }

  bool brownian_;
  double va_;
  double amplitude_;
};

const LawParameter kAmplitude{"V", "V", "m/s", 0.07};
const LawParameter kHold{"epsilon", "ε", "s", 0.2};

}  // namespace

std::vector<ClosedForm> forms::noisy_abp() {
  return {{"noisy_abp",
           {{"va", "va", "m/s", 0.01}, kAmplitude, kHold},
           [](std::vector<LawParameter> parameters, double wheel_base) {
             return std::shared_ptr<const Law>(std::make_shared<const DrawnWheelsLaw>(
                 "noisy_abp", std::move(parameters), wheel_base, false));
           }},
          {"bp", {kAmplitude, kHold}, [](std::vector<LawParameter> parameters, double wheel_base) {
             return std::shared_ptr<const Law>(std::make_shared<const DrawnWheelsLaw>(
                 "bp", std::move(parameters), wheel_base, true));
           }}};
}

}  // namespace lab::analysis
