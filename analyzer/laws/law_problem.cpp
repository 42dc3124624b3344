#include "analyzer/laws/law_problem.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "analyzer/laws/closed_forms.hpp"
#include "analyzer/laws/si_dimension.hpp"
#include "common/text/nearest_word.hpp"
#include "robot/language/formula.hpp"

namespace lab::analysis {
namespace {

using language::CompiledProgram;
using language::NamedText;
using language::Parameter;
using language::Problem;
using language::ProgramText;

constexpr int kLags = 200;
constexpr double kRounding = 1e-9;  // of the largest value: what differences of formulas leave

std::string quoted(const std::string& text) { return std::string("\"").append(text) + "\""; }

std::string numberIn(const language::Dimension& dimension) {
  return dimension == language::kPure ? "a number without unit"
                                      : "a number in " + unitText(dimension);
}

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

template <typename Items, typename Name>
std::string listed(const Items& items, const Name& name) {
  std::string list;
  for (const auto& item : items) list += (list.empty() ? "" : ", ") + name(item);
  return list;
}

/// "epsilon (s)"
std::string withUnit(const LawParameter& parameter) {
  return parameter.name + " (" + (parameter.unit.empty() ? "1" : parameter.unit) + ")";
}

const std::string* find(const std::vector<NamedText>& texts, std::string_view key) {
  const auto found = std::ranges::find(texts, key, &NamedText::first);
  return found == texts.end() ? nullptr : &found->second;
}

/// The check of a closed form and its parameters.
class ClosedFormCheck {
 public:
  ClosedFormCheck(const ProgramText& text, const CompiledProgram& compiled, const ClosedForm& form)
      : text_(text), compiled_(compiled), form_(form) {
    mapped_ = std::ranges::any_of(text.law, [](const NamedText& one) {
      return one.first != "name" && !language::isFormula(one.first);
    });
  }

  std::vector<Problem> problems() {
    for (const auto& [key, value] : text_.law) {
      if (key != "name") checkKey(key);
    }
    for (const LawParameter& parameter : form_.parameters) checkParameter(parameter);
    return std::move(problems_);
  }

 private:
  void checkKey(const std::string& key) {
    if (language::isFormula(key)) {
      problems_.push_back({"law." + key, 0,
                           "found a formula beside the closed form " + quoted(form_.name) +
                               ", expected one of both: remove " + key + " or name"});
      return;
    }
    if (std::ranges::find(form_.parameters, key, &LawParameter::name) != form_.parameters.end()) {
      return;
    }
    std::vector<std::string> names;
    for (const LawParameter& parameter : form_.parameters) names.push_back(parameter.name);
    problems_.push_back({"law." + key, 0,
                         "found an unknown parameter of " + quoted(form_.name) + ", expected " +
                             listed(form_.parameters, withUnit) + didYouMean(key, names)});
  }

  void checkParameter(const LawParameter& parameter) {
    const auto given = std::ranges::find(compiled_.law, parameter.name, &Parameter::name);
    if (given == compiled_.law.end()) {
      problems_.push_back({"law", 0, missing(parameter)});
      return;
    }
    const language::Dimension wanted = dimensionOf(parameter.unit);
    if (given->dimension == wanted || given->value == 0) return;
    problems_.push_back({(mapped_ ? "law." : "parameters.") + parameter.name, 0,
                         "found " + numberIn(given->dimension) + ", expected " + numberIn(wanted) +
                             " for " + parameter.name + " of the law " + quoted(form_.name) +
                             "; write an expression of the program's parameters with this unit"});
  }

  [[nodiscard]] std::string missing(const LawParameter& parameter) const {
    std::string text = "found no " + withUnit(parameter) + ", expected all parameters of " +
                       quoted(form_.name) + ": " + listed(form_.parameters, withUnit);
    if (mapped_) return text + "; add " + parameter.name + " = \"...\"";
    std::string map = "name = " + quoted(form_.name);
    for (const LawParameter& one : form_.parameters) {
      const bool own = find(text_.parameters, one.name) != nullptr;
      map += ", " + one.name + " = " + (own ? quoted(one.name) : "\"...\"");
    }
    const auto name = [](const NamedText& own) { return own.first; };
    const std::string has =
        text_.parameters.empty() ? "no parameters" : listed(text_.parameters, name);
    return text + "; the program has " + has + ": write law = {" + map + "}";
  }

  const ProgramText& text_;
  const CompiledProgram& compiled_;
  const ClosedForm& form_;
  bool mapped_ = false;  ///< The law gives the parameters; else the program has them.
  std::vector<Problem> problems_;
};

/// Why a formula cannot be what its key says; empty: it can.
std::string formulaProblem(const std::string& key, const std::string& text,
                           const CompiledProgram& compiled, const LagRange& lags) {
  const language::Dimension dimension = language::formulaDimension(key);
  const bool curve = language::isCurve(key);
  const language::Formula formula(text, compiled.parameters, dimension, curve);
  double largest = 0;
  for (int i = 0; i <= (curve ? kLags : 0); ++i) {
    const double tau = lags.shortest * std::pow(lags.longest / lags.shortest, i / double{kLags});
    const double value = formula(tau);
    largest = std::fmax(largest, value);
    if (std::isfinite(value) && value >= -kRounding * largest) continue;
    std::string found = "no finite number";
    if (std::isfinite(value)) {
      found = numberText(value);
      if (dimension != language::kPure) found.append(" ").append(unitText(dimension));
    }
    const std::string where = curve ? " at tau = " + numberText(tau) + " s" : "";
    const std::string range = curve ? " at all lags from " + numberText(lags.shortest) + " s to " +
                                          numberText(lags.longest) + " s"
                                    : "";
    return "is " + found + where + ", expected 0 or more" + range +
           "; check signs, brackets and divisions by 0";
  }
  return {};
}

}  // namespace

std::vector<Problem> lawProblems(const ProgramText& text, const CompiledProgram& compiled,
                                 const LagRange& lags) {
  if (const std::string* name = find(text.law, "name")) {
    if (const ClosedForm* form = findClosedForm(*name)) {
      return ClosedFormCheck(text, compiled, *form).problems();
    }
    std::vector<std::string> names;
    for (const ClosedForm& form : closedForms()) names.push_back(form.name);
    return {{"law.name", 0,
             "found " + quoted(*name) + ", expected the name of a closed form (" +
                 closedFormsWith([](const Law&) { return true; }) +
                 "), formulas as in law = {msd = \"...\"}, or no law: then the reference is "
                 "simulated" +
                 didYouMean(*name, names)}};
  }
  std::vector<Problem> problems;
  for (const auto& [key, formula] : text.law) {
    const std::string problem = formulaProblem(key, formula, compiled, lags);
    if (!problem.empty()) problems.push_back({"law." + key, 0, problem});
  }
  return problems;
}

}  // namespace lab::analysis
