/// The exact laws of the programs as the robots execute them, and the paper's formulas.
/// docs/theory.md derives them. "The paper" is Paramanick, Pal, Soni and Kumar (README.md).
#pragma once

#include <memory>

#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/law.hpp"
#include "analyzer/laws/law_of.hpp"

namespace lab::analysis {

/// The exact law of what the robot executes, at every lag, averaged over the phase of the hold at
/// which the observation begins. If no law exists (none known, durations of 0), every value is nan.
class ExactLaw {
 public:
  /// @param turning the angles of turns on the spot, uniform on (-180, 180] degrees by default,
  ///   which makes the paper's eq. 6 exact; laws without such turns ignore it
  explicit ExactLaw(const ProgramLaw& law, const Turning& turning = {})
      : law_(law), curves_(law->curves(turning)) {}

  [[nodiscard]] bool exists() const { return curves_ != nullptr; }
  [[nodiscard]] double msd(double tau) const { return curves_ ? curves_->msd(tau) : units::kNan; }
  [[nodiscard]] double angularMsd(double tau) const {
    return curves_ ? curves_->angularMsd(tau) : units::kNan;
  }
  [[nodiscard]] double velocityCorrelation(double s) const {
    return curves_ ? curves_->velocityCorrelation(s) : units::kNan;
  }
  [[nodiscard]] double diffusivity() const {
    return curves_ ? curves_->diffusivity() : units::kNan;
  }
  /// The persistence length, m: the integral over the path length l of <cos(change of the heading
  /// after l)>; nan if the speed is not constant. The paper's v / D_r is its limit for short holds.
  [[nodiscard]] double persistenceLength() const {
    return curves_ ? curves_->persistenceLength() : units::kNan;
  }
  [[nodiscard]] const ProgramLaw& program() const { return law_; }

 private:
  ProgramLaw law_;
  std::shared_ptr<const LawCurves> curves_;
};

/// The paper's 2 D_r tau in rad^2; nan for laws without D_r.
[[nodiscard]] inline double paperAngularMsd(const ProgramLaw& law, double tau) {
  return 2 * law->rotationalDiffusivity() * tau;
}

}  // namespace lab::analysis
