/// The laws that are known in closed form. A new one is a file forms/NAME.cpp with its class and
/// the function std::vector<ClosedForm> forms::NAME(); the build finds it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analyzer/laws/law.hpp"

namespace lab::analysis {

struct ClosedForm {
  std::string name;                      ///< As programs name it.
  std::vector<LawParameter> parameters;  ///< All are needed; the values are examples.
  /// @param parameters with values, in this order
  std::shared_ptr<const Law> (*make)(std::vector<LawParameter> parameters, double wheel_base);
};

[[nodiscard]] const std::vector<ClosedForm>& closedForms();

/// The same, made anew from all files of forms/. The build generates it.
[[nodiscard]] std::vector<ClosedForm> formsOfAllFiles();

/// nullptr: there is none with this name.
[[nodiscard]] const ClosedForm* findClosedForm(std::string_view name);

/// The names of the closed forms that satisfy `has`, as "one, two, three".
[[nodiscard]] std::string closedFormsWith(const std::function<bool(const Law&)>& has);

/// @param parameters names and values (SI units), all that the form has, in any order; others have
///   no meaning (lawProblems() refuses them where somebody writes them)
/// @param wheel_base distance between the wheels, m
/// @throws std::invalid_argument for an unknown name, or a parameter too few
[[nodiscard]] ProgramLaw closedForm(std::string_view name,
                                    const std::vector<std::pair<std::string, double>>& parameters,
                                    double wheel_base);

/// Distance between the wheels of the paper's robots, m.
inline constexpr double kPaperWheelBase = 0.075;

}  // namespace lab::analysis
