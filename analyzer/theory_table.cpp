#include "analyzer/theory_table.hpp"

#include <memory>

#include "analyzer/laws/bp_kurtosis.hpp"
#include "analyzer/laws/observation.hpp"
#include "analyzer/laws/phased_noise.hpp"

namespace lab::analysis {
namespace {

/// Windows that begin at fixed phases of the hold.
TheoryColumns phasedColumns(const ProgramLaw& law, const TheoryConditions& conditions) {
  const double va = law.kind == ProgramKind::kBp ? 0 : law.va;
  const HeldNoise noise = law.kind == ProgramKind::kAbp
                              ? HeldNoise::uniformTurning(law.v, law.eta, law.epsilon)
                              : HeldNoise::uniformWheels(va, law.V, law.wheel_base, law.epsilon);
  const auto phased = std::make_shared<const PhasedNoise>(noise);
  const auto mean = [=, phases = conditions.phases.value_or(1),
                     first = conditions.phase.value_or(law.epsilon)](auto member) {
    return [=](double tau) {
      return commensurateMean(law.epsilon, phases, first,
                              [&](double phase) { return ((*phased).*member)(tau, phase); });
    };
  };
  return {mean(&PhasedNoise::msd), mean(&PhasedNoise::angularMsd),
          mean(&PhasedNoise::velocityCorrelation), nullptr};
}

}  // namespace

TheoryColumns theoryColumns(const ProgramLaw& law, const TheoryConditions& conditions) {
  const ExactLaw exact(law, conditions.turning);
  TheoryColumns columns;
  if (isHeldNoise(law.kind) && (conditions.phase || conditions.phases)) {
    columns = phasedColumns(law, conditions);
  } else {
    const MeasurementModel blurred{conditions.exposure, 0, 0};
    columns.msd = [=](double tau) { return observedMsd(exact, blurred, tau); };
    columns.angular_msd = [=](double tau) { return observedAngularMsd(exact, blurred, tau); };
    columns.correlation = [=](double s) { return exact.velocityCorrelation(s); };
  }
  const double offset = 4 * conditions.sigma * conditions.sigma;
  const double angular_offset = 2 * conditions.sigma_theta * conditions.sigma_theta;
  columns.msd = [=, msd = columns.msd](double tau) { return msd(tau) + offset; };
  columns.angular_msd = [=, msd = columns.angular_msd](double tau) {
    return msd(tau) + angular_offset;
  };
  if (law.kind == ProgramKind::kBp) {
    const auto kurtosis = std::make_shared<const BpKurtosis>(law.V, law.wheel_base, law.epsilon);
    columns.kurtosis = [=](double tau) { return kurtosis->observed(tau, offset); };
  }
  return columns;
}

}  // namespace lab::analysis
