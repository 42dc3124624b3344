/// What is known of the motion of a program: its law. The closed forms are in files of their own
/// in this folder, and nothing outside it names them: the rest of the analyzer asks a law what it
/// can do.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/laws/random.hpp"
#include "analyzer/laws/turning.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

class HeldNoise;
class ProgramLaw;

/// Standard deviation of the rates of the robots' clocks (ceramic resonators), relative.
inline constexpr double kClockError = 0.005;

/// A parameter of a law.
struct LawParameter {
  std::string name;    ///< As in program files: "epsilon".
  std::string symbol;  ///< As in formulas: "ε".
  std::string unit;    ///< SI: "s".
  double value = 0;

  bool operator==(const LawParameter&) const = default;
};

/// The statistics of a law at every lag, averaged over the phase at which the observation begins.
class LawCurves {
 public:
  virtual ~LawCurves() = default;
  [[nodiscard]] virtual double msd(double tau) const = 0;                ///< m^2.
  [[nodiscard]] virtual double angularMsd(double tau) const = 0;         ///< rad^2.
  [[nodiscard]] virtual double velocityCorrelation(double s) const = 0;  ///< m^2/s^2.
  [[nodiscard]] virtual double diffusivity() const = 0;  ///< lim MSD / (4 tau), m^2/s.
  /// The integral over the path length of <cos(change of the heading)>, m; nan: not defined.
  [[nodiscard]] virtual double persistenceLength() const { return units::kNan; }
};

/// The kurtosis <r^4> / <r^2>^2 of the displacement.
class DisplacementKurtosis {
 public:
  virtual ~DisplacementKurtosis() = default;
  /// Observed with noise that adds `offset` (4 sigma^2, m^2) to the MSD; tau > 0.
  [[nodiscard]] virtual double observed(double tau, double offset) const = 0;
  [[nodiscard]] double kurtosis(double tau) const { return observed(tau, 0); }
};

/// An arc at constant speed and turning rate.
struct Arc {
  double speed = 0;     ///< m/s.
  double turning = 0;   ///< rad/s.
  double duration = 0;  ///< s.
};

/// The free motion of a program as a sequence of arcs: from a random time on in the stationary
/// state, or from the start of its program on if that state is not known.
class Motion {
 public:
  virtual ~Motion() = default;
  [[nodiscard]] virtual Arc first(Random& random) = 0;  ///< What is left of the first one.
  [[nodiscard]] virtual Arc next(Random& random) = 0;
};

/// Wheel speeds that are drawn at fixed intervals and held in between.
struct HeldDraws {
  double hold = 0;  ///< s.
  /// Variance of the squared turning rate of one draw over its squared mean: 0.8 (a uniform rate),
  /// 1.4 (the difference of two uniform wheel speeds).
  double spread = 0;
};

/// Both wheel speeds are drawn independently, uniform in mean +- half_width (m/s).
struct DrawnWheels {
  double mean = 0;
  double half_width = 0;
};

/// Straight runs and turns on the spot follow each other.
struct RunsAndTurns {
  double speed = 0;      ///< In runs, m/s.
  double rate = 0;       ///< At which runs end, 1/s.
  double turn_time = 0;  ///< Duration of a turn, s.
};

/// Measured quantities that the parameters of a law may follow from, SI units.
struct MeasuredMotion {
  double rotational_diffusivity = 0;
  double speed = 0;
  double amplitude = 0;  ///< Half width of the wheel speeds' range.
  double run_end_rate = 0;
  double turn_time = units::kNan;  ///< nan: not measured, it is as programmed.
};

/// A parameter that a fit may free; positive.
struct FitParameter {
  std::string name;   ///< Of the parameter.
  std::string label;  ///< Of the estimate.
  std::string unit;   ///< SI.
};

/// The law of a program with given parameters. A law that does not override a function does not
/// have that property. All laws of free motion have stationary increments.
class Law {
 public:
  Law(std::string name, std::vector<LawParameter> parameters, double wheel_base)
      : name_(std::move(name)), parameters_(std::move(parameters)), wheel_base_(wheel_base) {}
  virtual ~Law() = default;

  [[nodiscard]] const std::string& name() const { return name_; }  ///< "" for no law.
  [[nodiscard]] const std::vector<LawParameter>& parameters() const { return parameters_; }
  [[nodiscard]] double wheelBase() const { return wheel_base_; }  ///< m.
  [[nodiscard]] double parameter(std::string_view name) const;    ///< nan: it has none such.
  /// Whether both describe the same motion of the same robot.
  [[nodiscard]] virtual bool equals(const Law& other) const;

  [[nodiscard]] virtual std::string title() const { return name_; }  ///< For people.
  /// What the motion is compared with: "agrees with ...".
  [[nodiscard]] virtual std::string reference() const { return "the exact law"; }
  /// The statistics; nullptr if they do not exist (a duration of 0).
  /// @param turning the angles of turns; laws without turns ignore it
  [[nodiscard]] virtual std::shared_ptr<const LawCurves> curves(const Turning& turning) const;

  /// Why the motion cannot be judged, a sentence; empty: it can, if the law exists.
  [[nodiscard]] virtual std::string whyNoVerdict() const { return {}; }

  /// The curves are not known: their reference must be simulated by motion().
  [[nodiscard]] virtual bool isSimulated() const { return false; }

  // Nominal coefficients, exact functions of the parameters; nan: there is none such.
  [[nodiscard]] virtual double rotationalDiffusivity() const { return units::kNan; }
  [[nodiscard]] virtual double translationalDiffusivity() const { return units::kNan; }
  [[nodiscard]] virtual double meanSpeed() const { return units::kNan; }
  [[nodiscard]] virtual double neededWheelSpeed(double /*largest_turn*/) const {
    return units::kNan;
  }

  // The paper's formulas for comparison; they neglect how long draws are held.
  [[nodiscard]] virtual double paperMsd(double /*tau*/) const { return units::kNan; }
  [[nodiscard]] virtual std::string paperFormula() const { return {}; }  ///< "eq. 4".

  // Time scales, s.
  /// Mean time per independent draw (or per run with its turn); infinite: none is drawn.
  [[nodiscard]] virtual double drawTime() const { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] virtual double changesPerDraw() const { return 1; }
  [[nodiscard]] virtual std::string drawsName() const { return "draws of the noise"; }
  [[nodiscard]] virtual double changeTime() const { return units::kNan; }  ///< The shortest one.
  /// Lags beyond it contribute nothing to a fit.
  [[nodiscard]] virtual double longestChange() const { return units::kNan; }
  [[nodiscard]] virtual double persistenceTime() const { return units::kNan; }
  /// The curves are smooth between multiples of this time; 0: everywhere.
  [[nodiscard]] virtual double kinkSpacing() const { return 0; }
  [[nodiscard]] virtual double variationRate() const { return 0; }  ///< Bound of their rate, 1/s.

  // What the motion consists of.
  [[nodiscard]] virtual std::optional<HeldDraws> held() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<DrawnWheels> drawnWheels() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<RunsAndTurns> runs() const { return std::nullopt; }
  /// The speed while it drives straight or along an arc, if it is always the same, m/s.
  [[nodiscard]] virtual std::optional<double> constantSpeed() const { return std::nullopt; }
  /// The time, always the same, after which a new turning rate is drawn, s; 0: there is none such.
  [[nodiscard]] virtual double steadyHold() const { return 0; }
  /// The MSD is a straight line from one hold on, to lowest order.
  [[nodiscard]] virtual bool isDiffusive() const { return false; }
  /// The noise of the law for windows of a fixed phase; nullptr: its draws are not held.
  [[nodiscard]] virtual std::shared_ptr<const HeldNoise> heldNoise() const { return nullptr; }
  /// The curves of drawn wheels with another mean speed; nullptr: the wheels are not drawn.
  [[nodiscard]] virtual std::shared_ptr<const LawCurves> curvesAtMean(double /*mean*/) const {
    return nullptr;
  }
  [[nodiscard]] virtual std::shared_ptr<const DisplacementKurtosis> kurtosis() const {
    return nullptr;
  }
  [[nodiscard]] virtual std::unique_ptr<Motion> motion() const { return nullptr; }

  // Estimates and fits.
  [[nodiscard]] virtual std::string speedName() const { return "v"; }
  /// The parameter that is the mean speed; "" if there is none.
  [[nodiscard]] virtual std::string speedParameter() const { return {}; }
  [[nodiscard]] virtual std::string characteristicEstimate() const { return "D_r"; }
  /// The law with the parameters that follow from measured quantities; nullopt: they do not.
  [[nodiscard]] virtual std::optional<ProgramLaw> measured(const MeasuredMotion& motion) const;
  [[nodiscard]] virtual std::vector<FitParameter> fitParameters() const { return {}; }
  /// Durations that the robot's clock keeps. A fit takes them as programmed, unless it is asked to
  /// free them.
  [[nodiscard]] virtual std::vector<FitParameter> fitTimes() const { return {}; }
  /// The relative error of the MSD and the angular MSD over one recording of `observed` seconds.
  [[nodiscard]] virtual double relativeMsdError(double tau, double msd, double observed) const;
  [[nodiscard]] virtual double relativeAngularError(double tau, double observed) const;
  /// False: relativeMsdError() is much too large at short lags.
  [[nodiscard]] virtual bool predictsMsdError() const { return true; }

 private:
  std::string name_;
  std::vector<LawParameter> parameters_;
  double wheel_base_;
};

/// The law of a program, as a value; by default none.
class ProgramLaw {
 public:
  ProgramLaw();
  /// @param program the hash of its byte code; 0: of no particular program
  explicit ProgramLaw(std::shared_ptr<const Law> law, std::uint32_t program = 0)
      : law_(std::move(law)), program_(program) {}
  ProgramLaw(ProgramLaw law, std::uint32_t program)
      : law_(std::move(law.law_)), program_(program) {}

  const Law* operator->() const { return law_.get(); }
  const Law& operator*() const { return *law_; }
  /// False: nothing is known of the motion (standing, moved by hand).
  [[nodiscard]] bool known() const { return !law_->name().empty(); }
  [[nodiscard]] std::uint32_t program() const { return program_; }
  /// The same closed form with another value of a parameter.
  [[nodiscard]] ProgramLaw with(std::string_view parameter, double value) const;
  /// The same closed form on a robot whose clock takes `factor` times as long.
  [[nodiscard]] ProgramLaw slowed(double factor) const;
  /// The variance of the mean speed over a time T, by the steps of the motors, is this over T,
  /// m^2/s.
  [[nodiscard]] double speedScatter() const { return speed_scatter_; }
  [[nodiscard]] ProgramLaw withSpeedScatter(double scatter) const;
  /// The same with another mean speed, if it has one.
  [[nodiscard]] ProgramLaw withSpeed(double speed) const;

  bool operator==(const ProgramLaw& other) const {
    return program_ == other.program_ && (law_ == other.law_ || law_->equals(*other.law_));
  }

 private:
  std::shared_ptr<const Law> law_;
  std::uint32_t program_ = 0;
  double speed_scatter_ = 0;
};

}  // namespace lab::analysis
