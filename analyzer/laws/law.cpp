#include "analyzer/laws/law.hpp"

#include <cmath>
#include <stdexcept>

#include "analyzer/laws/closed_forms.hpp"

namespace lab::analysis {

double Law::parameter(std::string_view name) const {
  for (const LawParameter& one : parameters_) {
    if (one.name == name) return one.value;
  }
  return units::kNan;
}

bool Law::equals(const Law& other) const {
  return name_ == other.name_ && wheel_base_ == other.wheel_base_ &&
         parameters_ == other.parameters_;
}

std::shared_ptr<const LawCurves> Law::curves(const Turning& /*turning*/) const { return nullptr; }

std::optional<ProgramLaw> Law::measured(const MeasuredMotion& /*motion*/) const {
  return std::nullopt;
}

double Law::relativeMsdError(double tau, double /*msd*/, double observed) const {
  // Motion along one axis: the largest error of a Gaussian process without memory.
  return std::sqrt(4 * tau / 3 / observed);
}

double Law::relativeAngularError(double tau, double observed) const {
  return std::sqrt(4 * tau / 3 / observed);
}

ProgramLaw::ProgramLaw() {
  static const auto none = std::make_shared<const Law>("", std::vector<LawParameter>{}, 0);
  law_ = none;
}

ProgramLaw ProgramLaw::with(std::string_view parameter, double value) const {
  std::vector<std::pair<std::string, double>> values;
  bool found = false;
  for (const LawParameter& one : law_->parameters()) {
    found = found || one.name == parameter;
    values.emplace_back(one.name, one.name == parameter ? value : one.value);
  }
  if (!found) {
    throw std::invalid_argument("the law \"" + law_->name() + "\" has no parameter " +
                                std::string(parameter));
  }
  ProgramLaw changed = closedForm(law_->name(), values, law_->wheelBase());
  changed.program_ = program_;
  changed.speed_scatter_ = speed_scatter_;
  return changed;
}

ProgramLaw ProgramLaw::slowed(double factor) const {
  ProgramLaw slow = *this;
  for (const LawParameter& one : law_->parameters()) {
    if (one.unit == "s") slow = slow.with(one.name, one.value * factor);
    if (one.unit == "1/s") slow = slow.with(one.name, one.value / factor);
  }
  return slow;
}

ProgramLaw ProgramLaw::withSpeedScatter(double scatter) const {
  ProgramLaw changed = *this;
  changed.speed_scatter_ = scatter;
  return changed;
}

ProgramLaw ProgramLaw::withSpeed(double speed) const {
  const std::string parameter = law_->speedParameter();
  return parameter.empty() ? *this : with(parameter, speed);
}

}  // namespace lab::analysis
