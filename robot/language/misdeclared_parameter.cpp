#include "robot/language/misdeclared_parameter.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace lab::language {
namespace {

/// What a parameter may have been meant to be.
constexpr std::array<Dimension, 10> kUsualDimensions{{kPure,
                                                      kLength,
                                                      kTime,
                                                      kSpeed,
                                                      kRate,
                                                      kVoltage,
                                                      {-1, 0, 0},
                                                      {2, -1, 0},
                                                      {2, 0, 0},
                                                      {1, -2, 0}}};

}  // namespace

std::optional<Problem> misdeclaredParameter(const ProgramText& text,
                                            const ProgramChecker& checker) {
  constexpr std::size_t kMostParameters = 30;  // a bound of the time
  if (checker.hasAdvised() || checker.program().parameters.size() > kMostParameters) {
    return std::nullopt;
  }
  std::optional<Parameter> blamed;
  for (const Parameter& parameter : checker.program().parameters) {
    for (const Dimension& dimension : kUsualDimensions) {
      if (dimension == parameter.dimension) {
        continue;
      }
      ProgramChecker other(text, nullptr);
      other.assume(parameter.name, dimension);
      if (!other.check()) {
        continue;
      }
      if (blamed) {
        return std::nullopt;  // cannot be told
      }
      blamed = {parameter.name, 0, dimension};
    }
  }
  if (!blamed) {
    return std::nullopt;
  }
  const auto found =
      std::ranges::find(checker.program().parameters, blamed->name, &Parameter::name);
  const auto unit = [](const Dimension& dimension) {
    return dimension == kPure ? "without unit" : "in " + unitText(dimension);
  };
  return Problem{"parameters." + blamed->name, 0,
                 "found a number " + unit(found->dimension) + ", but " +
                     checker.errors().front().key + " needs '" + blamed->name +
                     "' to be a number " + unit(blamed->dimension) +
                     ": change the unit here, or the expression there"};
}

}  // namespace lab::language
