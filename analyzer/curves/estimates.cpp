#include "analyzer/curves/estimates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "analyzer/curves/clock_error.hpp"
#include "analyzer/curves/lags.hpp"
#include "analyzer/curves/robot_scatter.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/curves/turning_rate.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kBlocksPerReach = 5;  // minimal length of a block, in lags
constexpr double kManyBlocks = 1e9;
constexpr double kWholeTrack = 1e300;     // s
constexpr double kCorrectionShare = 0.1;  // share of a correction that counts as its uncertainty

/// The relative error of a quantity in a recording of length T that the law predicts, for
/// recordings that are too short for block errors: draws are independent from hold to hold, and the
/// difference of two lags has twice the error of the mean square of the draws (kurtosis of the
/// uniform distribution 9/5, of the sum of two 2.4).
double modelError(const ProgramLaw& law, Quantity quantity, double observed) {
  const HeldDraws held = law->held().value_or(HeldDraws{});
  const DrawnWheels wheels = law->drawnWheels().value_or(DrawnWheels{});
  const double draws = held.hold > 0 ? observed / held.hold : kNan;
  switch (quantity) {
    case kRotationalDiffusivity:
      return 2 * std::sqrt(held.spread / draws);
    case kTranslationalDiffusivity:
      return 2 * std::sqrt(1.4 / draws);
    case kAmplitude:
      return 0.5 * std::sqrt(1.4 / draws);
    case kSpeed:
      return wheels.mean != 0 ? wheels.half_width / std::abs(wheels.mean) / std::sqrt(6 * draws)
                              : 0;
    case kSlopeDiffusivity:
      return (law->isDiffusive() ? 1.15 : 0.8) * std::sqrt(20 * law->persistenceTime() / observed);
    case kPositionOffset:
    case kHeadingOffset:
    case kTumbleRate:
    case kQuantities:
      break;
  }
  return 0;
}

/// The 95 % interval: Student's t unless sigma is known otherwise than by the scatter of blocks
/// (known_error). Positive mean squares (scale) get an interval of the logarithm: a recording that
/// fluctuates low also scatters less, which a symmetric interval does not take into account.
void setInterval(Estimate& estimate, double degrees_of_freedom, bool known_error, bool scale) {
  const double half =
      studentQuantile(known_error ? kManyBlocks : degrees_of_freedom) * estimate.sigma;
  const bool relative = scale && estimate.value > 0 && half < 3 * estimate.value;
  const double factor = relative ? std::exp(half / estimate.value) : 1;
  estimate.low95 = relative ? estimate.value / factor : estimate.value - half;
  estimate.high95 = relative ? estimate.value * factor : estimate.value + half;
  estimate.n_eff = degrees_of_freedom + 1;
  if (!std::isfinite(estimate.value)) {
    estimate.note += "; too little data";
  } else if (degrees_of_freedom + 1 < static_cast<double>(kMinReliableGroups)) {
    estimate.note += "; few blocks, error not below the law's own";
  }
}

/// Collects the estimates of one program.
class Report {
 public:
  Report(const Estimator& estimator, const BlockData& data)
      : law_(estimator.law()),
        data_(data),
        estimator_(estimator),
        total_(estimator.total()),
        observed_(total_.time) {
    main_ = replicate(kRotationalDiffusivity);
    if (data.tracks.size() > 1) robots_ = replicatesOf(groupBlocks(data, kWholeTrack));
  }

  std::vector<Estimate> all() {
    list();
    meanTurning();
    holdTime();
    for (Estimate& one : list_) widenByClocks(one, robots(), clockPower(one.name));
    return std::move(list_);
  }

 private:
  [[nodiscard]] double robots() const { return static_cast<double>(data_.tracks.size()); }

  /// Wheels make the speed without a clock. V is measured at the programmed hold, and D_t of the
  /// robot is proportional to V^2 times the hold.
  [[nodiscard]] double clockPower(const std::string& name) const {
    if (!law_.known() || name == law_->speedName() || name == "omega") return 0;
    return name == "V" ? 0.5 : 1;
  }

  void list() {
    if (!law_.known()) {
      direct(kSpeed, "v", "m/s", kNan, "forward displacement over time");
      return;
    }
    if (law_->held()) {
      direct(kRotationalDiffusivity, "D_r", "rad^2/s", law_->rotationalDiffusivity(),
             "[A(2 epsilon) - A(epsilon)] / (2 epsilon) of the angular MSD");
    }
    direct(kSpeed, law_->speedName(), "m/s", law_->meanSpeed(),
           law_->runs() ? "forward displacement over run time" : "forward displacement over time");
    if (const auto wheels = law_->drawnWheels()) {
      direct(kAmplitude, "V", "m/s", wheels->half_width,
             "MSD(epsilon) - MSD(one frame) over the exact law's");
      direct(kTranslationalDiffusivity, "D_t", "m^2/s", law_->translationalDiffusivity(),
             "[MSD(2 epsilon) - MSD(epsilon)] / (4 epsilon), mean speed's part removed");
    }
    if (const auto runs = law_->runs()) tumbling(*runs);
    derived();
    if (std::isnan(law_->persistenceTime())) return;
    direct(kSlopeDiffusivity, "D_slope", "m^2/s", ExactLaw(law_).diffusivity(),
           "slope of the MSD from 5 to 10 persistence times, intercept free");
  }

  /// The time between draws, from when the turning rate changes.
  void holdTime() {
    const std::optional<HoldPeriod> hold = holdPeriod(data_.holds);
    if (!hold) return;
    const double half = studentQuantile(HoldSpectra::kGroups - 1) * hold->sigma;
    list_.push_back({std::isnan(law_->parameter("epsilon")) ? "hold" : "epsilon", "s", hold->value,
                     hold->sigma, hold->value - half, hold->value + half, hold->programmed,
                     hold->blocks,
                     "when the turning rate changes (line in a spectrum of the headings)"});
  }

  /// Whether it circles.
  void meanTurning() {
    const std::optional<TurningRate> rate = turningRate(law_, total_);
    if (!rate) return;
    const double half = studentQuantile(kManyBlocks) * rate->sigma;
    list_.push_back({"omega", "rad/s", rate->value, rate->sigma, rate->value - half,
                     rate->value + half, 0, observed_ / law_->drawTime(),
                     "net rotation over time, positive to the left; the error is that of the law"});
  }

  Replicates replicate(Quantity quantity) const {
    return replicatesOf(groupBlocks(data_, kBlocksPerReach * estimator_.reach(quantity)));
  }

  Replicates replicatesOf(const std::vector<BlockGroup>& groups) const {
    return jackknife(groups, totalOf(groups, data_, total_), estimator_.neededLags(),
                     [this](const BlockSums& sums) {
                       const Quantities q = estimator_(sums);
                       return std::vector<double>(q.begin(), q.end());
                     });
  }

  /// Robots differ in clocks and wheels, which the scatter of blocks of one robot does not show.
  /// @param sigma standard error by the scatter of robots
  void widen(Estimate& estimate, double sigma) const {
    if (robots_.shares.size() < 2) return;
    if (estimate.low95 > 0) sigma /= estimate.value;
    widenTo(estimate, {sigma, std::max(1.0, robots_.degreesOfFreedom())});
  }

  void direct(Quantity quantity, const std::string& name, const char* unit, double theory,
              const char* note) {
    const bool own = estimator_.reach(quantity) != estimator_.reach(kRotationalDiffusivity);
    const Replicates replicates = own ? replicate(quantity) : main_;
    Estimate estimate{
        name, unit, replicates.values[quantity], replicates.sigma(quantity), 0, 0, theory, 0, note};
    const double dof = replicates.degreesOfFreedom();
    bool known = boundedByModel(
        estimate, modelError(law_, quantity, observed_) * std::abs(estimate.value), dof);
    if (quantity == kSpeed) {
      const SpeedError error = speedError(replicates, finiteOrZero(estimate.sigma));
      estimate.sigma = error.sigma;
      known = known || error.known;
    }
    setInterval(estimate, dof, known, quantity != kSpeed);
    if (robots_.shares.size() > 1) widen(estimate, robots_.sigma(quantity));
    list_.push_back(estimate);
  }

  struct SpeedError {
    double sigma = 0;
    bool known = false;  ///< From the tracker noise, not from the blocks.
  };

  /// With few blocks, sets sigma to the prediction of the law if that is larger. Returns whether it
  /// did.
  static bool boundedByModel(Estimate& estimate, double model, double dof) {
    if (dof + 1 >= static_cast<double>(kMinReliableGroups) || estimate.sigma >= model) {
      return false;
    }
    estimate.sigma = model;
    return true;
  }

  /// The error of the mean forward speed. The noise of a frame enters the steps before and after it
  /// with opposite signs and mostly cancels, except if the two steps are in different blocks: the
  /// scatter of blocks is too large by a known amount. The remaining scatter counts only if it
  /// exceeds the noise significantly (draws of the wheels, unevenness of real ones). That by the
  /// steps of the motors is known.
  SpeedError speedError(const Replicates& replicates, double block_sigma) const {
    const BlockSums& total = total_;
    const Quantities q = estimator_(total);
    const double time = total.forward_time;
    const double scale = law_->runs() ? total.run_span / total.run_time : 1;
    const double sigma2 = finiteOrZero(std::max(0.0, q[kPositionOffset] / 4)) * scale * scale;
    const double heading2 = finiteOrZero(std::max(0.0, q[kHeadingOffset] / 2));
    const LagSums& first = total.lags.front();
    const double turn2 = first.angular_windows > 0
                             ? std::max(0.0, first.a2 / first.angular_windows - 2 * heading2)
                             : 0;
    const auto tracks = static_cast<double>(data_.tracks.size());
    const auto blocks = static_cast<double>(replicates.shares.size());
    // The directions of two successive steps differ by the turn between their middles. Its mean
    // square is proportional to the square of the time between them.
    const double steps_seen = total.steps + total.long_steps;
    const double mean_frames = time / (data_.frame_period * std::max(1.0, steps_seen));
    const double frames2 = total.steps + total.long_frames2;
    const double turning = 0.5 * turn2 * (frames2 + steps_seen * mean_frames * mean_frames);
    const double open_ends = 2 * (total.joins + total.breaks + tracks);
    const double noise = sigma2 * (turning + 0.5 * heading2 * steps_seen + open_ends);
    const double scatter = block_sigma * block_sigma * time * time;
    const double excess = scatter - 2 * sigma2 * (blocks - tracks) - noise;
    const double resolution = 2 * std::sqrt(2 / std::max(1.0, blocks - 1)) * scatter;
    const double steps = law_.speedScatter() * time;
    const double variance =
        (noise + std::max(steps, excess > resolution ? excess : 0)) / (time * time);
    // The correction for chords and heading noise is only of lowest order.
    const double correction = q[kSpeed] - scale * total.forward / time;
    return {std::hypot(std::sqrt(variance), kCorrectionShare * correction), excess <= resolution};
  }

  void tumbling(const RunsAndTurns& runs) {
    const BlockSums& total = total_;
    const double run_time = total.run_time;
    const Interval count = poissonInterval(total.tumbles);
    Estimate gamma{"gamma",
                   "1/s",
                   main_.values[kTumbleRate],
                   std::sqrt(total.tumbles) / run_time,
                   count.low / run_time,
                   count.high / run_time,
                   runs.rate,
                   total.tumbles,
                   "tumbles over run time (right-censored maximum likelihood)"};
    Estimate tau{"tau_r",          "s",
                 1 / gamma.value,  gamma.sigma / (gamma.value * gamma.value),
                 1 / gamma.high95, 1 / gamma.low95,
                 1 / runs.rate,    total.tumbles,
                 "1 / gamma"};
    if (!(total.tumbles > 0)) {
      gamma.value = run_time > 0 ? 0 : kNan;
      gamma.note += "; no tumble seen";
      tau.value = kNan;
      tau.note += "; no tumble seen";
    }
    if (robots_.shares.size() > 1) {
      const double sigma = robots_.sigma(kTumbleRate);
      widen(gamma, sigma);
      widen(tau, sigma / (gamma.value * gamma.value));
    }
    list_.push_back(gamma);
    list_.push_back(tau);
  }

  /// The program with the measured parameters.
  std::optional<ProgramLaw> measured(const std::vector<double>& q) const {
    return law_->measured({q[kRotationalDiffusivity], q[kSpeed], q[kAmplitude], q[kTumbleRate]});
  }

  /// D and L_s of a law.
  struct Derived {
    explicit Derived(const ProgramLaw& law) {
      const ExactLaw exact(law);
      values = {exact.diffusivity(), exact.persistenceLength()};
    }
    std::array<double, 2> values;
  };

  /// D and L_s: the exact law at the measured parameters, errors by linear propagation.
  void derived() {
    const std::optional<ProgramLaw> now = measured(main_.values);
    if (!now) return;
    const Derived value(*now);
    const Derived theory(law_);
    std::vector<std::pair<Quantity, Derived>> slopes;
    for (const Quantity q : {kRotationalDiffusivity, kSpeed, kAmplitude, kTumbleRate}) {
      std::vector<double> shifted = main_.values;
      const double step = 1e-3 * shifted[q];
      if (!std::isfinite(step)) continue;  // the law does not depend on it
      shifted[q] += step;
      Derived& slope = slopes.emplace_back(q, Derived(*measured(shifted))).second;
      for (std::size_t k = 0; k < slope.values.size(); ++k) {
        slope.values[k] = (slope.values[k] - value.values[k]) / step;
      }
    }
    const auto propagate = [&](std::size_t k, const char* name, const char* unit,
                               const char* note) {
      std::vector<double> without(main_.without.size(), value.values[k]);
      std::vector<double> without_robot(robots_.without.size(), value.values[k]);
      double model2 = 0;
      for (const auto& [q, slope] : slopes) {
        if (!std::isfinite(slope.values[k])) continue;
        for (std::size_t b = 0; b < without.size(); ++b) {
          without[b] += slope.values[k] * (main_.without[b][q] - main_.values[q]);
        }
        for (std::size_t r = 0; r < without_robot.size(); ++r) {
          without_robot[r] += slope.values[k] * (robots_.without[r][q] - robots_.values[q]);
        }
        const double model = slope.values[k] * main_.values[q] * modelError(law_, q, observed_);
        model2 += model * model;
      }
      Estimate estimate{name, unit, value.values[k],  main_.sigmaOf(value.values[k], without),
                        0,    0,    theory.values[k], 0,
                        note};
      const double dof = main_.degreesOfFreedom();
      const bool known = boundedByModel(estimate, std::sqrt(model2), dof);
      setInterval(estimate, dof, known, true);
      if (robots_.shares.size() > 1) {
        widen(estimate, robots_.sigmaOf(value.values[k], without_robot));
      }
      list_.push_back(estimate);
    };
    propagate(0, "D", "m^2/s", "exact law at the measured parameters");
    if (law_->constantSpeed()) {
      propagate(1, "L_s", "m", "integral of C(l), exact law at the measured parameters");
    }
  }

  const ProgramLaw& law_;
  const BlockData& data_;
  const Estimator& estimator_;
  const BlockSums& total_;
  double observed_;
  Replicates main_;
  Replicates robots_;  ///< One group per robot; empty: a single robot.
  std::vector<Estimate> list_;
};

}  // namespace

std::vector<Estimate> estimate(const ProgramLaw& law, const BlockData& data) {
  if (!(data.observed() > 0)) {
    return {};
  }
  return estimate(Estimator(law, data), data);
}

std::vector<Estimate> estimate(const Estimator& estimator, const BlockData& data) {
  return Report(estimator, data).all();
}

std::vector<std::string> estimateNames(const ProgramLaw& law) {
  if (!law.known()) return {"v"};
  std::vector<std::string> names;
  if (law->held()) names.emplace_back("D_r");
  names.push_back(law->speedName());
  if (law->drawnWheels()) names.insert(names.end(), {"V", "D_t"});
  if (law->runs()) names.insert(names.end(), {"gamma", "tau_r"});
  constexpr MeasuredMotion kAny{1, 1, 1, 1, units::kNan};
  if (law->measured(kAny)) {
    names.emplace_back("D");
    if (law->constantSpeed()) names.emplace_back("L_s");
  }
  if (!std::isnan(law->persistenceTime())) names.emplace_back("D_slope");
  return names;
}

}  // namespace lab::analysis
