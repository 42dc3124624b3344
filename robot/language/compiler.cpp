#include "robot/language/compiler.hpp"

#include <optional>

#include "robot/language/misdeclared_parameter.hpp"
#include "robot/language/program_checker.hpp"
#include "robot/language/program_code.hpp"
#include "robot/language/program_names.hpp"
#include "robot/language/range_check.hpp"

namespace lab::language {

CompiledProgram compile(const ProgramText& text, const dynamics::WheelLimits& limits,
                        Suggest suggest) {
  CompiledProgram result;
  result.name = text.name;
  result.errors = problemsOfNames(text);
  if (!result.ok()) return result;

  ProgramChecker checker(text, suggest);
  const bool right = checker.check();
  result.parameters = checker.program().parameters;
  result.law = checker.program().law;
  result.states = checker.program().states;
  if (!right) {
    result.errors = checker.errors();
    if (const auto misdeclared = misdeclaredParameter(text, checker)) {
      result.errors = {*misdeclared};
    }
    return result;
  }

  checker.findRanges();
  checkRanges(text, checker.program(), limits, result);
  if (result.ok()) writeProgramCode(checker.program(), result);
  return result;
}

}  // namespace lab::language
