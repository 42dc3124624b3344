/// What is known of the laws of programs. The laws are the analyzer's (analyzer/laws/), on which
/// common does not depend: who executes experiments passes this in.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/programs/program.hpp"
#include "robot/language/compiler.hpp"
#include "robot/language/program_text.hpp"

namespace lab {

/// The lags of measured curves, s.
struct LagRange {
  double shortest = 1.0 / 30;
  double longest = 100;
};

/// What is wrong with the law of a program that compiles. Keys: "law", "law.NAME".
using LawCheck = std::function<std::vector<language::Problem>(const language::ProgramText&,
                                                              const language::CompiledProgram&)>;

/// An empty function knows nothing, and nothing is refused.
struct LawKnowledge {
  std::function<std::vector<language::Problem>(const language::ProgramText&,
                                               const language::CompiledProgram&, const LagRange&)>
      problems;
  /// The names of the numbers that are measured of a program.
  /// @param wheel_base [m]
  std::function<std::vector<std::string>(const Program&, double wheel_base)> estimates;
};

}  // namespace lab
