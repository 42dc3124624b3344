#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/persistent_msd.hpp"
#include "analyzer/laws/rtp_law.hpp"

namespace lab::analysis {
namespace forms {
std::vector<ClosedForm> rtp();
}
namespace {

constexpr double kPi = std::numbers::pi;

class RtpCurves : public LawCurves {
 public:
  explicit RtpCurves(const RtpLaw& law) : law_(law) {}

  [[nodiscard]] double msd(double tau) const override { return law_.msd(tau); }
  [[nodiscard]] double angularMsd(double tau) const override { return law_.angularMsd(tau); }
  [[nodiscard]] double velocityCorrelation(double s) const override {
    return law_.velocityCorrelation(s);
  }
  [[nodiscard]] double diffusivity() const override { return law_.diffusivity(); }
  [[nodiscard]] double persistenceLength() const override { return law_.persistenceLength(); }

 private:
  RtpLaw law_;
};

/// Runs at speed v end at the rate gamma; tumbles of duration tau_t turn on the spot.
class Rtp : public Law {
 public:
  Rtp(std::vector<LawParameter> parameters, double wheel_base)
      : Law("rtp", std::move(parameters), wheel_base),
        v_(parameter("v")),
        gamma_(parameter("gamma")),
        tau_t_(parameter("tau_t")) {}

  [[nodiscard]] std::string title() const override { return "RTP"; }
  [[nodiscard]] std::shared_ptr<const LawCurves> curves(const Turning& turning) const override {
    if (!(gamma_ > 0 && tau_t_ > 0)) return nullptr;
    return std::make_shared<const RtpCurves>(RtpLaw(v_, gamma_, tau_t_, turning));
  }

  [[nodiscard]] double meanSpeed() const override { return v_; }
  [[nodiscard]] double neededWheelSpeed(double largest_turn) const override {
    return std::max(std::abs(v_), 0.5 * largest_turn * wheelBase() / tau_t_);
  }

  [[nodiscard]] double paperMsd(double tau) const override {
    return exponentialMsd(v_ * v_ / (1 + gamma_ * tau_t_), gamma_, tau);
  }
  [[nodiscard]] std::string paperFormula() const override { return "eq. 6"; }

  [[nodiscard]] double drawTime() const override { return 1 / gamma_ + tau_t_; }
  [[nodiscard]] double changesPerDraw() const override { return 2; }
  [[nodiscard]] std::string drawsName() const override { return "tumbles"; }
  [[nodiscard]] double changeTime() const override { return std::min(1 / gamma_, tau_t_); }
  [[nodiscard]] double longestChange() const override { return 4 * std::max(1 / gamma_, tau_t_); }
  [[nodiscard]] double persistenceTime() const override { return 1 / gamma_; }
  [[nodiscard]] double kinkSpacing() const override { return tau_t_; }
  /// The decay rate of the runs, and twice the largest turning rate of a tumble.
  [[nodiscard]] double variationRate() const override { return gamma_ + 2 * kPi / tau_t_; }
  [[nodiscard]] std::optional<RunsAndTurns> runs() const override {
    return RunsAndTurns{v_, gamma_, tau_t_};
  }
  [[nodiscard]] std::optional<double> constantSpeed() const override { return v_; }

  [[nodiscard]] std::unique_ptr<Motion> motion() const override {
    class Walk : public Motion {
     public:
      explicit Walk(const Rtp& rtp) : v_(rtp.v_), gamma_(rtp.gamma_), tau_t_(rtp.tau_t_) {}
      /// The rest of a run is distributed like a run; that of a tumble is not.
      Arc first(Random& random) override {
        running_ = random.uniform() * (1 + gamma_ * tau_t_) < gamma_ * tau_t_;
        Arc arc = next(random);
        if (!running_) arc.duration = random.uniform(0, tau_t_);
        return arc;
      }
      Arc next(Random& random) override {
        running_ = !running_;
        if (running_) return {v_, 0, random.exponential(gamma_)};
        return {0, random.uniform(-kPi, kPi) / tau_t_, tau_t_};
      }

     private:
      double v_, gamma_, tau_t_;
      bool running_ = false;
    };
    return std::make_unique<Walk>(*this);
  }

  [[nodiscard]] std::string speedParameter() const override { return "v"; }
  [[nodiscard]] std::string characteristicEstimate() const override { return "gamma"; }
  [[nodiscard]] std::optional<ProgramLaw> measured(const MeasuredMotion& motion) const override {
    const double turn_time = std::isfinite(motion.turn_time) ? motion.turn_time : tau_t_;
    return closedForm(name(),
                      {{"v", motion.speed}, {"gamma", motion.run_end_rate}, {"tau_t", turn_time}},
                      wheelBase());
  }
  [[nodiscard]] std::vector<FitParameter> fitParameters() const override {
    return {{"v", "v", "m/s"}, {"gamma", "gamma", "1/s"}};
  }
  [[nodiscard]] std::vector<FitParameter> fitTimes() const override {
    return {{"tau_t", "tau_t", "s"}};
  }
  /// The share of run time in the recording also scatters.
  [[nodiscard]] double relativeMsdError(double tau, double, double observed) const override {
    const double cycle = 1 / gamma_ + tau_t_;
    return std::sqrt((2 * tau / 3 + tau_t_ * tau_t_ / cycle) / observed);
  }
  [[nodiscard]] double relativeAngularError(double tau, double observed) const override {
    return std::sqrt((4 * tau / 3 + 1.8 * (1 / gamma_ + tau_t_)) / observed);
  }

 private:
  double v_;
  double gamma_;
  double tau_t_;
};

}  // namespace

std::vector<ClosedForm> forms::rtp() {
  return {{"rtp",
           {{"v", "v", "m/s", 0.05}, {"gamma", "γ", "1/s", 1}, {"tau_t", "τt", "s", 0.5}},
           [](std::vector<LawParameter> parameters, double wheel_base) {
             return std::shared_ptr<const Law>(
                 std::make_shared<const Rtp>(std::move(parameters), wheel_base));
           }}};
}

}  // namespace lab::analysis
