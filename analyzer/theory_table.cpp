#include "analyzer/theory_table.hpp"

#include <memory>

#include "analyzer/laws/observation.hpp"
#include "analyzer/laws/phased_noise.hpp"

namespace lab::analysis {
namespace {

/// Windows that begin at fixed phases of the hold.
TheoryColumns phasedColumns(const ProgramLaw& law, const TheoryConditions& conditions) {
  const double hold = law->drawTime();
  const auto phased = std::make_shared<const PhasedNoise>(*law->heldNoise());
  const auto mean = [=, phases = conditions.phases.value_or(1),
                     first = conditions.phase.value_or(hold)](auto member) {
    return [=](double tau) {
      return commensurateMean(hold, phases, first,
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
  if (law->held() && (conditions.phase || conditions.phases)) {
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
  if (const auto kurtosis = law->kurtosis()) {
    columns.kurtosis = [=](double tau) { return kurtosis->observed(tau, offset); };
  }
  return columns;
}

}  // namespace lab::analysis
