#include "analyzer/laws/closed_forms.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace lab::analysis {

const std::vector<ClosedForm>& closedForms() {
  static const std::vector<ClosedForm> forms = formsOfAllFiles();
  return forms;
}

const ClosedForm* findClosedForm(std::string_view name) {
  const auto found = std::ranges::find(closedForms(), name, &ClosedForm::name);
  return found == closedForms().end() ? nullptr : &*found;
}

std::string closedFormsWith(const std::function<bool(const Law&)>& has) {
  std::string names;
  for (const ClosedForm& form : closedForms()) {
    if (!has(*form.make(form.parameters, kPaperWheelBase))) continue;
    names += (names.empty() ? "" : ", ") + form.name;
  }
  return names;
}

ProgramLaw closedForm(std::string_view name,
                      const std::vector<std::pair<std::string, double>>& parameters,
                      double wheel_base) {
  const ClosedForm* form = findClosedForm(name);
  if (form == nullptr) {
    throw std::invalid_argument("law: found \"" + std::string(name) + "\", expected one of " +
                                closedFormsWith([](const Law&) { return true; }));
  }
  std::vector<LawParameter> values = form->parameters;
  for (LawParameter& value : values) {
    const auto given =
        std::ranges::find(parameters, value.name, &std::pair<std::string, double>::first);
    if (given == parameters.end()) {
      throw std::invalid_argument("law \"" + form->name + "\": parameter " + value.name + " (" +
                                  value.unit + ") is missing");
    }
    value.value = given->second;
  }
  return ProgramLaw(form->make(std::move(values), wheel_base));
}

}  // namespace lab::analysis
